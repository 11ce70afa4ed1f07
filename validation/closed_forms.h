/// @file
/// Room `validation`: cases with a closed form or a benchmark figure. Sources at the head of each case's file.
#pragma once

namespace tissue_contact {

class Report;

void validateOneContact(Report& report);
void validateIncline(Report& report);
void validateDirectionalIncline(Report& report);
void validateHeldContact(Report& report);
void validateSpringBlock(Report& report);
void validateStickSlip(Report& report);
void validateShearLag(Report& report);
void validateCapstan(Report& report);
void validateElasticity(Report& report);
void validateElasticModels(Report& report);
void validateMembrane(Report& report);
void validateHeldAndPressed(Report& report);
void validateLayerIndentation(Report& report);
void validatePartialSlip(Report& report);
void validateLanding(Report& report);
void validatePressureFriction(Report& report);
void validateBenchmarkBlock(Report& report);
void validateCoarsePress(Report& report);
void validatePressLaws(Report& report);
void validateGrasp(Report& report);
void validateInvariances(Report& report);
void validatePloughing(Report& report);

}  // namespace tissue_contact
