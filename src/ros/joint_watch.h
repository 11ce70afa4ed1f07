/// @file
/// Room `ros`, private: joint states that move an instrument otherwise than its robot: other names, other units, other clocks.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/joint_silence.h"
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
/// do where its driver or its recording has ended. So they do where two drivers share a topic and one ends (JointSilence).
class JointWatch {
 public:
  /// @param player must outlive this object, as the simulator must.
  /// @param longest_silence_s of a joint that has come (JointSilence), > 0.
  JointWatch(const Simulator& simulator, const JointStatePlayer& player, double longest_silence_s);

  /// @param topic index into JointStatePlayer::topics(). Allocates when the names are others than in the topic's message before.
  /// @param now_s receipt, or the stamp in a recording.
  void note(int topic, const JointStateSample& sample, double now_s);

  /// After each moment that the player has played.
  void notePlayed();

  /// At the end of a recording: for each instrument a line about names, one about joints named twice and one about units, and for each topic one
  /// about its clock or its silence and one about joints that it no longer named, where there is something to say.
  std::vector<std::string> findings() const;

  /// While joint states come: what findings() would say now and has not been told, but for silence of topics, each line once per instrument, of joints
  /// once per silence. Names only 5 s after the first call, so that every topic has been heard.
  /// @param now_s on a clock that never goes back
  std::vector<std::string> takeNews(double now_s);

  /// Of the joints that were silent, while others came on their topics, when takeNews() last looked, which it does some times a second.
  /// Empty: none was.
  const std::string& silentJoints() const { return silent_joints_; }

 private:
  struct Known {
    std::size_t place = 0;  ///< in the message
    int instrument = 0;
    int joint = 0;
  };
  struct Topic {
    std::vector<int> listeners;  ///< instruments
    std::vector<std::string> last_names;
    std::vector<Known> known;         ///< of last_names
    std::vector<std::size_t> joints;  ///< the same, numbered through all instruments
    double lead_s = 0.0;              ///< largest (JointStatePlayer::lead_s)
    double idle_s = 0.0;              ///< largest, while it is not ahead
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
  std::size_t numberOf(int instrument, int joint) const;
  std::vector<std::string> silentTexts(const std::vector<JointSilence::Silent>& silent, bool is_over) const;
  void takeSilences(double now_s, std::vector<std::string>& lines);

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  std::vector<Topic> topics_;
  std::vector<Seen> seen_;  ///< per instrument
  std::optional<double> began_s_;
  std::vector<std::size_t> first_numbers_;  ///< per instrument: of its first joint
  JointSilence silence_;
  std::optional<double> looked_s_;  ///< for silent joints
  std::string silent_joints_;
};

/// Of the first topic that only updates and is ahead of the others by more than the scene's max_gap_s: what is the matter and what to do. Empty: none is.
std::string aheadText(const JointStatePlayer& player, double max_gap_s);

}  // namespace tissue_contact
