/// @file
/// Room `validation`: cases that break simulators: extreme materials, steps, friction, geometry and motion. Each states
/// the band its force must stay in.
#pragma once

namespace tissue_contact {

class Report;

void validateHardIncompressible(Report& report);
void validateHardStiffnessContrast(Report& report);
void validateHardTimeSteps(Report& report);
void validateHardFriction(Report& report);
void validateHardSharpTip(Report& report);
void validateHardBadElements(Report& report);
void validateHardInversion(Report& report);
void validateHardFastEntry(Report& report);
void validateHardPlacement(Report& report);
void validateHardManyContacts(Report& report);
void validateHardPinch(Report& report);
void validateHardLongHold(Report& report);
void validateHardCycles(Report& report);
void validateHardJointStates(Report& report);

}  // namespace tissue_contact
