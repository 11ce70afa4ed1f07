/// @file
/// Room `simulation`, private: where the instruments are during an interval. Joint targets in; link poses at both ends
/// of each implicit step, velocities of material points and the number of steps the motion needs out.
#pragma once

#include <vector>

#include "simulation/joint_way.h"
#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

class InstrumentMotion {
 public:
  /// @param instruments must outlive this object.
  explicit InstrumentMotion(const std::vector<Instrument>& instruments);

  /// Positions, deflections and poses as they were saved.
  void carry(int instrument, StateArchive& archive);

  void reset();                                          ///< all instruments at their initial joint positions
  void place(int instrument, const VectorX& positions);  ///< there at once, at rest, not deflected

  /// Prepares the interval to `targets`, through `velocities` (null: none known), and returns the number of equal steps to cut it into: none longer than
  /// max_step_s, none in which a shape moves more than half its smallest half extent, so that it cannot pass through a
  /// feature thinner than itself, and none in which a joint turns by more than 1 rad (a full turn ends where it began).
  /// A motion that would need more than kMaxTravelSteps steps, or kMaxTravelStepsPerSecond for its duration, is a jump:
  /// the instruments are placed at the targets. With most_steps > 0 there are no more than that, however long they get.
  /// Precondition: sizes of `targets`; duration_s <= kMostSteps * max_step_s.
  int begin(double duration_s, double max_step_s, const std::vector<VectorX>& targets, int most_steps = 0,
            const JointVelocities* velocities = nullptr);
  bool jumped() const { return jumped_; }  ///< by the last begin()

  /// Sets the poses at the end of a step to those at this fraction (0..1] of the interval.
  void moveTo(double fraction);
  void finishStep();  ///< the end of the step becomes the start of the next

  /// What contacts did to a compliant joint in the step that was finished last.
  struct JointLoad {
    double effort = 0.0;           ///< N m or N, along the joint
    double effort_before = 0.0;    ///< of the step before
    double friction = 0.0;         ///< of `effort`: of contacts that slide, against how they do
    double friction_before = 0.0;  ///< of `effort_before`
    double stiffness = 0.0;        ///< what they take off it for each rad or m in that step; 0: nothing touches
    double step_s = 0.0;           ///< its length
    double way = 0.0;              ///< that the joint gave way in it, rad or m
    double least_caution = 1.0;    ///< below which that may not be
    double caution = 1.0;          ///< what `stiffness` is multiplied by, as the joint's way so far tells
  };
  void setLoad(int instrument, int joint, const JointLoad& load) { states_[instrument].loads[joint] = load; }
  const JointLoad& load(int instrument, int joint) const { return states_[instrument].loads[joint]; }
  /// After moveTo(), until poseDeflected(): the joint is by so much farther than the joint states say, rad or m.
  void deflect(int instrument, int joint, double deflection) { states_[instrument].deflections[joint] = deflection; }
  void poseDeflected();
  /// How far the joint states have moved a joint in this step, rad or m. Of instruments with compliant joints.
  double wayOf(int instrument, int joint) const {
    return states_[instrument].positions[joint] - states_[instrument].positions_before[joint];
  }

  const VectorX& positions(int instrument) const { return states_[instrument].positions; }  ///< by the joint states
  /// Of each joint; empty without compliant ones.
  const VectorX& deflections(int instrument) const { return states_[instrument].deflections; }
  const std::vector<std::vector<Pose>>& startPoses() const { return X_WL_; }  ///< [instrument][link of its model]
  const std::vector<std::vector<Pose>>& endPoses() const { return X_WL_end_; }

  /// Mean velocity (m/s, world) over the step of the material point of a touching link that is at p_W at its start.
  Vector3 pointVelocity(int instrument, int contact_link, const Vector3& p_W, double dt_s) const;

  /// Bound on how far any point of any shape moves in the step, m.
  double longestTravel() const { return longestTravel(false); }
  /// How far a joint may go without any shape it moves going farther than this share of its smallest half extent, rad or m; joints
  /// between them as far out as their limits let them. Infinite where it moves none.
  double longestWay(int instrument, int joint, double share) const;
  double smallestHalfExtent(int instrument, int contact_link, int shape) const;

  static constexpr double kMostSteps = 1e9;  ///< an int holds them; no interval that anyone means has more
  static constexpr double kMaxTravelSteps = 2000.0;
  /// And so many for each second of it: a shaft of 5 mm may move at 250 m/s, a blade of 0.5 mm at 25; robots stay below
  /// 10.
  static constexpr double kMaxTravelStepsPerSecond = 2e5;

 private:
  struct MovingShape {
    Vector3 center;               ///< in the link frame
    double smallest_half_extent;  ///< m
    double bounding_radius;       ///< of the shape about `center`, m
  };
  struct MovingLink {
    int link;  ///< index into the model's links
    std::vector<MovingShape> shapes;
  };
  struct State {
    std::vector<MovingLink> links;
    VectorX start, target, positions;
    std::vector<JointWay> ways;  ///< of each joint from start to target
    // Empty without compliant joints:
    VectorX positions_before;  ///< at the start of the step
    VectorX deflections;
    std::vector<JointLoad> loads;
    VectorX deflected;  ///< scratch: positions and deflections
  };
  void put(int instrument, const VectorX& positions);
  void poseEnd(int instrument);
  double longestTravel(bool per_half_extent) const;
  /// The longest of one step per half extent, of the whole interval cut into so many; of those looked at so far once it
  /// is beyond `most`.
  double longestTravelOver(double steps, double most);
  bool anyBent() const;        ///< any joint's way
  double travelBound() const;  ///< no less than that of all steps summed, however many; costs a step's kinematics

  const std::vector<Instrument>& instruments_;
  std::vector<State> states_;
  std::vector<std::vector<Pose>> X_WL_, X_WL_end_, X_WL_before_;
  bool jumped_ = false;
};

}  // namespace tissue_contact
