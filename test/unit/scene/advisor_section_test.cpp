/// The advisor section of a scene.
#include "scene_fixture.h"

namespace tissue_contact {
namespace advisor_section_test {

const std::string kScene = std::string(kSmallestScene) + R"(advisor:
  sleep: never
  sleep_error: 0.01
  rotations: auto
  self_contact: always
  friction_path: general
)";

TEST_F(SceneTest, FillsTheAdvisorSection) {
  const AdvisorDescription advisor = parse(kScene).advisor;
  EXPECT_FALSE(advisor.sleep);
  EXPECT_EQ(advisor.sleep_error, 0.01);
  EXPECT_TRUE(advisor.adapt_rotations);
  EXPECT_FALSE(advisor.skip_folds);
  EXPECT_TRUE(advisor.general_friction);
}

TEST_F(SceneTest, AdvisorDefaultsAreThoseOfTheDocument) {
  for (const std::string& scene : {std::string(kSmallestScene), std::string(kSmallestScene) + "advisor: {}\n"}) {
    const AdvisorDescription advisor = parse(scene).advisor;
    EXPECT_TRUE(advisor.sleep);
    EXPECT_EQ(advisor.sleep_error, 0.001);
    EXPECT_FALSE(advisor.adapt_rotations);
    EXPECT_TRUE(advisor.skip_folds);
    EXPECT_FALSE(advisor.general_friction);
  }
}

const BadScene kBadAdvisors[] = {
    {"sleep: never", "sleep: sometimes", "10: advisor.sleep", "allowed here: auto, never"},
    {"sleep: never", "sleep: false", "10: advisor.sleep", "allowed here: auto, never"},
    {"sleep: never", "sleeping: never", "10: advisor.sleeping", "unknown key"},
    {"error: 0.01", "error: 0.2", "11: advisor.sleep_error", "0.1 % is 0.001"},
    {"error: 0.01", "error: -0.001", "11: advisor.sleep_error", "0.1 % is 0.001"},
    {"error: 0.01", "error: .nan", "11: advisor.sleep_error", "nan"},
    {"rotations: auto", "rotations: never", "12: advisor.rotations", "allowed here: auto, always"},
    {"self_contact: always", "self_contact: never", "13: advisor.self_contact", "allowed here: auto, always"},
    {"path: general", "path: fast", "14: advisor.friction_path", "allowed here: auto, general"},
};

TEST_F(SceneTest, NamesBadAdvisorValues) { expectAllRefused(kScene, kBadAdvisors); }

}  // namespace advisor_section_test
}  // namespace tissue_contact
