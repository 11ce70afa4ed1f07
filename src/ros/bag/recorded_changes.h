/// @file
/// Room `ros`, private: the numbers of a scene that were changed while a bag was recorded. A bag and the moment played last in; the
/// changed scene out when its moment has come.
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tissue_contact/scene/tuning.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// The file is not trusted, see JointStateBag. All changes are read and checked at once, since a recorder may have got one later than the
/// joint states that followed it: they come by connections of their own. What counts is the stamp they hold.
class RecordedChanges {
 public:
  /// @param topic of Changes messages; empty: the only one that has some, if any has.
  /// @param scene without them; must outlive this.
  /// @throws std::runtime_error when the bag cannot be read, several topics have changes and none is named, the named one has none, or
  ///   a change is not one of this scene.
  /// @param recording_begins of the first joint state. A change recorded before it is a latched one: it holds from the start, whatever
  ///   its loop, which the recording begins in. So the first one tells its loop, too, where it is recorded soon after and no loop has begun
  ///   meanwhile: a node says its changes again when one begins.
  RecordedChanges(const std::string& file, const std::string& topic, const Scene& scene, ros::Time recording_begins);

  /// Of changes to other numbers than before.
  std::size_t count() const { return changes_.size(); }
  std::size_t taken() const { return taken_; }

  /// The scene from the next step on, if a change is due that was not taken yet.
  /// @param loop how often time has gone backwards.
  /// @param played_ns stamp of the moment played last; none: none was.
  /// @param next_ns of the moment that comes; 0: none is ready. Where it lies before a change that seems to be due, what was played
  ///   was one stray stamp ahead of the others.
  std::optional<Scene> takeDue(std::int64_t loop, const std::optional<std::int64_t>& played_ns, std::int64_t next_ns);

 private:
  struct Change {
    std::int64_t loop = 0;
    std::int64_t stamp_ns = 0;
    bool is_latched = false;
    std::vector<TunedNumber> numbers;
  };

  const Scene& scene_;
  std::vector<Change> changes_;
  std::size_t taken_ = 0;
  std::int64_t first_loop_ = 0;  ///< that the recording begins in
};

}  // namespace tissue_contact
