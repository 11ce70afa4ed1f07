/// @file
/// Room `contact`, private: prepared mesh shapes on disk, named by their content.
#pragma once

#include <string>

#include "contact/shape/mesh_field.h"

namespace tissue_contact {

/// 32 hexadecimal digits from the mesh's vertices and triangles (scale applied), the options and the file format.
std::string fieldKey(const TriangleMesh& mesh, double sample_count);

/// False when there is no such file or it is damaged, foreign or of another size than it says, and where everybody may write
/// to the directory; `field` is then unchanged. An empty directory is no cache.
bool readField(const std::string& directory, const std::string& key, MeshField& field);

/// As WholeFile: readers and other writers see a whole file or none. Then removes the oldest files beyond a quarter of a
/// gigabyte; files that are not of this cache are left alone. Makes the directory for its owner alone.
/// @return why it was not written; empty when all went well or there is no cache.
std::string writeField(const std::string& directory, const std::string& key, const MeshField& field);

}  // namespace tissue_contact
