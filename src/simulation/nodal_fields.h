/// @file
/// Room `simulation`, private: what a picture shows of a tissue beside where it is: contact pressure and strain, per node. Mesh,
/// positions and contacts in; one number per node out. Costs nothing unless called.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/solved_contact.h"

namespace tissue_contact {

/// Per node a third of the area vectors of the surface triangles around it, m^2, pointing out of a volume; 0 inside.
void nodalAreas(const std::vector<Triangle>& surface, const NodalVectors& x, NodalVectors& areas);

/// The pressure that all contacts together exert on each node, Pa, >= 0: the share it has of their normal forces, along its inward
/// normal, over its area. As in contact_pressure.h, but for the rim of the patch, where areas are whole here: sum p_a A_a is
/// the force on a flat face. Pushing from both sides of a membrane cancels. Contacts at nodes that `areas` does not have are left out.
/// @param areas see nodalAreas(). @param is_membrane pressed on either side.
void nodalPressure(const std::vector<SolvedContact>& contacts, int tissue, const NodalVectors& areas, bool is_membrane,
                   VectorX& pressure);

/// equivalentStrain() of the elements around each node, mean by their volumes at rest; of a membrane, that is without tetrahedra, of
/// its triangles by their areas, strained in their planes alone. 0 at nodes of no element. Allocates.
void nodalStrain(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Triangle>& surface,
                 const NodalVectors& rest, const NodalVectors& x, VectorX& strain);

}  // namespace tissue_contact
