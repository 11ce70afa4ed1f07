/// @file
/// Room `ros`, private: joint states that move an instrument otherwise than its robot: other names, other units, other clocks.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// What would put a tool silently in a wrong place.
///
/// Names. A message with one known joint is accepted, so a joint that goes by another name would stay where it is. A foreign name alone
/// is usual (/joint_states of several arms), and so is a joint that no message names (jaws that were not recorded); both together are not.
///
/// Two positions of one joint in a message: the last counts, which may be that of another arm.
///
/// Units. Degrees and millimetres are numbers like others, but lie far outside the URDF's limits. A little outside is usual (calibration,
/// limits that somebody guessed), so a position counts from beyond the limits by as much as they are apart; limits of 0 and 0 are none.
///
/// Clocks. What a topic that only updates says of the future is not taken until time is there: its joints stand still meanwhile, and so they
/// do where its driver or its recording has ended.
class JointWatch {
 public:
  /// @param player must outlive this object, as the simulator must.
  JointWatch(const Simulator& simulator, const JointStatePlayer& player);

  /// @param topic index into JointStatePlayer::topics(). Allocates when the names are others than in the topic's message before.
  void note(int topic, const JointStateSample& sample);

  /// After each moment that the player has played.
  void notePlayed();

  /// At the end of a recording: for each instrument a line about names, one about joints named twice and one about units, and for each topic one
  /// about its clock or its silence, where there is something to say.
  std::vector<std::string> findings() const;

  /// While joint states come: what findings() would say now and has not been told, but for silence, each line once per instrument. Names only 5 s after
  /// the first call, so that every topic has been heard.
  /// @param now_s on a clock that never goes back
  std::vector<std::string> takeNews(double now_s);

 private:
  struct Known {
    std::size_t place = 0;  ///< in the message
    int instrument = 0;
    int joint = 0;
  };
  struct Topic {
    std::vector<int> listeners;  ///< instruments
    std::vector<std::string> last_names;
    std::vector<Known> known;  ///< of last_names
    double lead_s = 0.0;       ///< largest (JointStatePlayer::lead_s)
    double idle_s = 0.0;       ///< largest, while it is not ahead
    bool told_lead = false;
  };
  struct Seen {
    std::set<int> joints;
    std::vector<std::string> foreign;  ///< the first few, each once
    std::map<int, double> outside;     ///< the first position of each joint far outside its limits
    std::set<int> twice;               ///< joints that some message names more than once
    bool told_names = false;
    bool told_limits = false;
    bool told_twice = false;
  };

  void noteNames(Topic& heard, const std::vector<std::string>& names);
  std::string namesText(std::size_t instrument) const;
  std::string limitsText(std::size_t instrument) const;
  std::string twiceText(std::size_t instrument) const;
  std::string silenceText(std::size_t topic) const;

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  std::vector<Topic> topics_;
  std::vector<Seen> seen_;  ///< per instrument
  std::optional<double> began_s_;
};

/// Of the first topic that only updates and is ahead of the others by more than the scene's max_gap_s: what is the matter and what to do. Empty: none is.
std::string aheadText(const JointStatePlayer& player, double max_gap_s);

}  // namespace tissue_contact
