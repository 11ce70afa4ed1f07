/// Keys set from outside a scene's file: what they make of it, and that they are refused with the words of the file.
#include <chrono>

#include "scene_fixture.h"

namespace tissue_contact {
namespace settings_test {

using Settings = std::vector<std::string>;

class SettingsTest : public SceneTest {
 protected:
  Scene with(const Settings& settings, const std::string& yaml = kFullScene) const {
    return parseScene(
        yaml, path("scene.yaml"), [this](const std::string&) { return directory_.path().string(); }, settings);
  }

  std::string refusalOf(const Settings& settings, const std::string& yaml = kFullScene) const {
    std::string message = tissue_contact::refusal([&] { with(settings, yaml); });
    const std::string directory = path("");
    if (message.rfind(directory, 0) == 0) message.erase(0, directory.size());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }

  void expectBegins(const Settings& settings, const std::string& beginning) const {
    const std::string message = refusalOf(settings);
    EXPECT_EQ(message.rfind(beginning, 0), 0U) << message;
  }
};

TEST_F(SettingsTest, TakeThePlaceOfWhatTheFileSays) {
  const Scene scene =
      with({"tissues.pad.material.youngs_modulus_pa=4000", "friction.1.static=0.9", "friction[0].kinetic=0.25",
            "instruments.arm.contact_links.jaw.shapes.0.sphere.radius_m=0.003", "tissues[1].pose.position_m=[1, 2, 3]",
            "tissues.pad.block.cells[2]=5", "world_frame=room", "instruments.arm.joint_names.\"outer.yaw\"=yaw2",
            "solver.tolerance=1e-9"});
  EXPECT_EQ(scene.tissues[0].material.youngs_modulus_pa, 4000.0);
  EXPECT_EQ(scene.tissues[0].material.poissons_ratio, 0.45);
  EXPECT_EQ(scene.friction[1].law.static_coefficients[0], 0.9);
  EXPECT_EQ(scene.friction[0].law.kinetic_coefficients[0], 0.25);
  EXPECT_EQ(scene.friction[0].law.static_coefficients[0], 0.6);
  EXPECT_EQ(std::get<SphereGeometry>(scene.instruments[0].contact_links[1].shapes[0].geometry).radius_m, 0.003);
  EXPECT_EQ(scene.tissues[1].pose.X.translation(), Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(std::get<BlockDescription>(scene.tissues[0].geometry).cells, (std::array<int, 3>{10, 8, 5}));
  EXPECT_EQ(scene.world_frame, "room");
  EXPECT_EQ(scene.instruments[0].joint_names.at("outer.yaw"), "yaw2");
  EXPECT_EQ(scene.instruments[0].joint_names.at("outer_yaw"), "yaw");
  EXPECT_EQ(scene.solver.tolerance, 1e-9);
  EXPECT_EQ(scene.step.max_step_s, 0.002);
}

TEST_F(SettingsTest, AddWhatTheFileLeavesOut) {
  const Scene scene = with({"step.max_step_s=0.004", "tissues.pad.damping={stiffness_s: 0.001}",
                            "tissues.pad.pose.position_m=[0, 0, 1]", "friction=[]"},
                           kSmallestScene);
  EXPECT_EQ(scene.step.max_step_s, 0.004);
  EXPECT_EQ(scene.tissues[0].damping.stiffness_s, 0.001);
  EXPECT_EQ(scene.tissues[0].pose.X.translation().z(), 1.0);
}

TEST_F(SettingsTest, KnowWhatAWordIsShortFor) {
  const std::string yaml = replaced(replaced(kSmallestScene,
                                             "{youngs_modulus_pa: 5000, poissons_ratio: 0.45, "
                                             "density_kg_per_m3: 1000}",
                                             "liver\n    refinement: auto"),
                                    "tip_link: tip", "tip_link: tip\n    joint_state_topics: [/js]");
  const Scene as_it_is = with({}, yaml);
  const Scene scene = with({"tissues.pad.material.youngs_modulus_pa=4321", "tissues.pad.refinement.cell_m=0.001",
                            "instruments.arm.contact_links.tip.shapes=[sphere: {radius_m: 0.004}]",
                            "instruments.arm.joint_state_topics.0.triggers=true"},
                           yaml);
  EXPECT_EQ(scene.tissues[0].material.youngs_modulus_pa, 4321.0);
  EXPECT_EQ(scene.tissues[0].material.poissons_ratio, as_it_is.tissues[0].material.poissons_ratio);
  EXPECT_EQ(scene.tissues[0].refinement.cell_m, 0.001);
  EXPECT_EQ(scene.instruments[0].contact_links[0].link, "tip");
  EXPECT_EQ(scene.instruments[0].contact_links[0].shapes.size(), 1U);
  EXPECT_EQ(scene.instruments[0].joint_state_topics[0].name, "/js");
}

/// An alias is the same text twice, not the same thing.
TEST_F(SettingsTest, ReachOnlyWhatTheyName) {
  const std::string yaml = replaced(kSmallestScene, "instruments:",
                                    "  - name: other\n    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}\n"
                                    "    material: *soft\ninstruments:");
  const Scene scene =
      with({"tissues.other.material.youngs_modulus_pa=1"}, replaced(yaml, "material: {y", "material: &soft {y"));
  EXPECT_EQ(scene.tissues[0].material.youngs_modulus_pa, 5000.0);
  EXPECT_EQ(scene.tissues[1].material.youngs_modulus_pa, 1.0);
}

TEST_F(SettingsTest, AreRefusedAsTheFileIs) {
  expectBegins({"tissues.pad.material.youngs_modulus=4000"},
               "--set tissues.pad.material.youngs_modulus=4000: tissues[0].material.youngs_modulus: unknown key; did "
               "you mean \"youngs_modulus_pa\"? allowed here: ");
  expectBegins({"tissue.pad.material.youngs_modulus_pa=4000"},
               "--set tissue.pad.material.youngs_modulus_pa=4000: tissue: unknown key; did you mean \"tissues\"?");
  expectBegins({"world_frame=a", "step.max_step_s=-1"},
               "--set step.max_step_s=-1: step.max_step_s: is \"-1\"; it must be ");
  expectBegins({"step.max_step_s=nan"}, "--set step.max_step_s=nan: step.max_step_s: is \"nan\"; it must be ");
  expectBegins({"step.max_step_s=\"0.001\""}, "--set step.max_step_s=\"0.001\": step.max_step_s: is the text ");
  expectBegins({"step={max_step: 0.001}"},
               "--set step={max_step: 0.001}: step.max_step: unknown key; did you mean \"max_step_s\"?");
  expectBegins({"solver.iterations="}, "--set solver.iterations=: solver.iterations: is empty; it must be a number");
  expectBegins({"tissues.pad.material.youngs_modulus_pa=[1, 2"},
               "--set tissues.pad.material.youngs_modulus_pa=[1, 2: (YAML syntax): ");
  expectBegins({"tissues.pad.mesh.file=organ.vtk"},
               "--set tissues.pad.mesh.file=organ.vtk: tissues[0].mesh: cannot be given");
  expectBegins({"tissues.pad.name=organ"}, "scene.yaml:27 (with --set tissues.pad.name=organ): tissues[1]: the name");
}

/// The file is at fault only with the setting: both are named, and lines stay those of the file.
TEST_F(SettingsTest, AreNamedBesideWhatTheyMakeWrong) {
  expectBegins({"friction.0.static=0.1"}, "--set friction.0.static=0.1: friction[0].static: ");
  const std::string bad = replaced(kFullScene, "mass_per_s: 0.5", "mass_per_s: -1");
  EXPECT_EQ(
      refusalOf({"tissues.pad.material.model=linear"}, bad)
          .rfind("scene.yaml:21 (with --set tissues.pad.material.model=linear): tissues[0].damping.mass_per_s: ", 0),
      0U);
}

TEST_F(SettingsTest, NameWhatIsThere) {
  expectBegins(
      {"tissues.pat.pressure_pa=1"},
      "--set tissues.pat.pressure_pa=1: tissues has no element \"pat\"; did you mean \"pad\"? there are pad, organ; "
      "its length is 2, indices begin with 0");
  expectBegins({"friction.2.static=1"}, "--set friction.2.static=1: friction has no element \"2\"; its length is 2");
  expectBegins({"tissues.pad.damping.mass_per_s.x=1"},
               "--set tissues.pad.damping.mass_per_s.x=1: tissues[0].damping.mass_per_s is \"0.5\"; it has no \"x\"");
  const std::string twice = replaced(kFullScene, "- shaft", "- jaw");
  EXPECT_EQ(
      refusalOf({"instruments.arm.contact_links.jaw.shapes=[]"}, twice)
          .rfind("--set instruments.arm.contact_links.jaw.shapes=[]: instruments[0].contact_links has several elements "
                 "\"jaw\"; give the index: 0 or 1",
                 0),
      0U);
}

TEST_F(SettingsTest, ThatAreNoneAreRefused) {
  for (const char* bad : {"", "=1", "tissues", ".=1", "a..b=1", "tissues[0=1", "tissues[0]x=1", "\"a=1", "a[]=1",
                          "a]=1", "tissues.\"pad\"x=1", "a\"b\"=1"}) {
    EXPECT_EQ(refusalOf({bad}).rfind("--set " + std::string(bad) + ": ", 0), 0U) << bad;
  }
  expectBegins({"step.max_step_s=0.001", "step.max_step_s=0.002"},
               "--set step.max_step_s=0.002: would undo --set step.max_step_s=0.001");
  expectBegins({"step.max_step_s=0.001", "step={max_gap_s: 1}"},
               "--set step={max_gap_s: 1}: would undo --set step.max");
  EXPECT_NO_THROW(with({"step={max_gap_s: 1}", "step.max_step_s=0.001"}));
  EXPECT_NO_THROW(with({"tissues.pad.pressure_pa=1", "tissues.organ.pressure_pa=1"}));
}

TEST_F(SettingsTest, AreBounded) {
  EXPECT_NE(refusalOf(Settings(1001, "a=1")).find("--set is given 1001 times; at most 1000"), std::string::npos);
  EXPECT_NE(refusalOf({"world_frame=" + std::string(5000, 'x')}).find("at most 4096 are allowed"), std::string::npos);
  std::string deep = "a";
  for (int i = 0; i < 40; ++i) deep += ".a";
  EXPECT_NE(refusalOf({deep + "=1"}).find("more than 32 parts"), std::string::npos);
  EXPECT_NE(refusalOf({"friction=" + std::string(40, '[') + std::string(40, ']')}).find("nested"), std::string::npos);
  const auto start = std::chrono::steady_clock::now();
  const std::string aliases =
      "friction=[&a [x,x,x,x,x,x,x,x],&b [*a,*a,*a,*a,*a,*a,*a,*a],&c [*b,*b,*b,*b,*b,*b,*b,*b],"
      "&d [*c,*c,*c,*c,*c,*c,*c,*c],&e [*d,*d,*d,*d,*d,*d,*d,*d],[*e,*e,*e,*e,*e,*e,*e,*e]]";
  EXPECT_NE(refusalOf({aliases}).find("more than 100000 values"), std::string::npos);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

}  // namespace settings_test
}  // namespace tissue_contact
