/// @file
/// The section `publish` of a scene: what the ros room reads beside the core.
#include "ros/publish/publish_options.h"

#include "scene/read_more.h"
#include "unit/scene/scene_fixture.h"

namespace tissue_contact {
namespace publish_options_test {

class PublishTest : public SceneTest {
 protected:
  PublishOptions read(const std::string& yaml) const {
    PublishOptions options;
    write("scene.yaml", yaml);
    loadScene(path("scene.yaml"), nullptr, {}, [&](const YamlMap& file) { options = parsePublish(file); });
    return options;
  }

  std::string refusal(const std::string& publish) const {
    const std::string yaml = kSmallestScene + ("publish: " + publish);
    return tissue_contact::refusal([&] { read(yaml); }).substr(path("").size());
  }
};

TEST_F(PublishTest, FillsTheSection) {
  const PublishOptions options = read(std::string(kSmallestScene) +
                                      "publish: {mesh_rate_hz: 1, contacts_rate_hz: 2, status_rate_hz: 3, "
                                      "markers_rate_hz: 0, tf: true, crtk: true}\n");
  EXPECT_EQ(options.mesh_rate_hz, 1.0);
  EXPECT_EQ(options.contacts_rate_hz, 2.0);
  EXPECT_EQ(options.status_rate_hz, 3.0);
  EXPECT_EQ(options.markers_rate_hz, 0.0);
  EXPECT_TRUE(options.tf);
  EXPECT_TRUE(options.crtk);
}

TEST_F(PublishTest, DefaultsAreThoseOfTheDocument) {
  for (const char* scene : {"", "publish: {}\n"}) {
    const PublishOptions options = read(kSmallestScene + std::string(scene));
    EXPECT_EQ(options.mesh_rate_hz, 30.0);
    EXPECT_EQ(options.contacts_rate_hz, 100.0);
    EXPECT_EQ(options.status_rate_hz, 10.0);
    EXPECT_EQ(options.markers_rate_hz, 30.0);
    EXPECT_FALSE(options.tf);
    EXPECT_FALSE(options.crtk);
  }
}

TEST_F(PublishTest, RefusesBadValuesWithTheirPlace) {
  EXPECT_EQ(refusal("{tf: yes}"), "scene.yaml:9: publish.tf: is \"yes\"; it must be true or false");
  EXPECT_EQ(refusal("{tf: \"true\"}"), "scene.yaml:9: publish.tf: is \"true\"; it must be true or false");
  EXPECT_EQ(refusal("{markers_rate_hz: -1}"),
            "scene.yaml:9: publish.markers_rate_hz: is \"-1\"; it must be a number >= 0 and <= 10000 Hz; "
            "0 switches the topic off");
  EXPECT_EQ(refusal("{rate_hz: 1}").find("scene.yaml:9: publish.rate_hz: unknown key; "), 0U);
  EXPECT_EQ(refusal("30").find("scene.yaml:9: publish: is \"30\"; it must be a map"), 0U);
}

TEST(PublishedMesh, IsOneOfTwoWords) {
  EXPECT_EQ(toPublishedMesh("p", "refined"), PublishedMesh::kRefined);
  EXPECT_EQ(toPublishedMesh("p", "unrefined"), PublishedMesh::kUnrefined);
  for (const char* bad : {"", "Refined", "coarse", "0", "unrefined "}) {
    EXPECT_EQ(refusal([&] { toPublishedMesh("parameter 'p'", bad); }),
              "parameter 'p' is \"" + std::string(bad) + "\"; it must be refined or unrefined; default refined");
  }
}

}  // namespace publish_options_test
}  // namespace tissue_contact
