/// @file
/// Room `ros`, private: joints that are no longer named on a topic on which others still come. No ROS and no clock inside.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace tissue_contact {

/// Two drivers may share a topic, each with joints of its own. When one dies, the topic goes on and its joints stay where they were, in
/// tissue perhaps. A joint that was never named is none of them. Not thread-safe.
///
/// Time is that of the topic on which the joint was named last, and passes only while something comes there: a topic that is silent as a
/// whole makes no joint of it silent, and its pause counts as half of `longest_s` at most, since who comes first after it is no news.
/// Where time goes back by no more than that (two drivers' clocks), it stands.
class JointSilence {
 public:
  struct Silent {
    std::size_t joint = 0;
    std::size_t topic = 0;  ///< on which it was named last
    double silent_s = 0.0;
  };

  /// @param longest_s that a joint may be silent, > 0; one that comes more rarely may be for three times its longest usual interval so far.
  explicit JointSilence(double longest_s) : longest_s_(longest_s) {}

  /// A joint state came. Allocates for topics and joints that were not heard before.
  /// @param now_s its time; @param joints that it names, each by a number of its own, whatever the topic.
  void note(std::size_t topic, double now_s, const std::vector<std::size_t>& joints);

  /// Those silent now, by number.
  std::vector<Silent> now() const;
  /// Of those the ones that this has not returned in their present silence.
  std::vector<Silent> takeNew();
  /// The longest silence of each joint that has ever been silent.
  std::vector<Silent> longest() const;

 private:
  struct Topic {
    std::optional<double> newest_s;
    double passed_s = 0.0;
  };
  struct Joint {
    std::optional<std::size_t> topic;  ///< none: never named
    double named_s = 0.0;              ///< of the topic's passed_s
    double longest_s = 0.0;            ///< that it may be silent, by its usual intervals; 0: named once at most
    Silent longest;                    ///< silence that has ended
    bool told = false;                 ///< of the present one
  };

  void passTime(Topic& topic, double now_s) const;
  void noteJoint(std::size_t number, std::size_t topic);
  double silence(const Joint& joint) const;

  double longest_s_;
  std::vector<Topic> topics_;
  std::vector<Joint> joints_;
};

}  // namespace tissue_contact
