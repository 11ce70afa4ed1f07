#include "instrument/urdfdom_document.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <cstddef>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "instrument/xml_tags.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {
namespace {

// A URDF needs 5 levels (robot, link, visual, geometry, mesh); extensions such as gazebo's nest a little deeper.
constexpr std::size_t kMaxXmlDepth = 64;
// urdfdom frees a chain of links recursively, so an endless chain overflows the stack. The largest humanoids have some
// hundred links.
constexpr std::size_t kMaxLinks = 10000;
constexpr std::size_t kMaxReasonLength = 600;

std::mutex& consoleBridgeMutex() {
  static std::mutex mutex;
  return mutex;
}

/// While it lives, collects the errors that urdfdom logs and keeps them off stderr.
class CapturedErrors : public console_bridge::OutputHandler {
 public:
  CapturedErrors()
      : lock_(consoleBridgeMutex()),
        previous_(console_bridge::getOutputHandler()),
        previous_level_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    console_bridge::useOutputHandler(this);
  }
  ~CapturedErrors() override {
    console_bridge::useOutputHandler(previous_);
    console_bridge::setLogLevel(previous_level_);
  }
  CapturedErrors(const CapturedErrors&) = delete;
  CapturedErrors& operator=(const CapturedErrors&) = delete;

  void log(const std::string& text, console_bridge::LogLevel /*level*/, const char* /*file*/, int /*line*/) override {
    if (errors_.size() < kMaxReasonLength) errors_ += (errors_.empty() ? "" : "; ") + text;
    // urdfdom drops a link's remaining parts when one of them is malformed, says so, and goes on. A malformed colour
    // alone costs nothing.
    lost_something_ = lost_something_ || text.rfind("Material", 0) != 0;
  }

  const std::string& errors() const { return errors_; }
  bool lostSomething() const { return lost_something_; }

 private:
  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  console_bridge::LogLevel previous_level_;
  std::string errors_;
  bool lost_something_ = false;
};

bool isShape(std::string_view tag) { return tag == "box" || tag == "cylinder" || tag == "sphere" || tag == "mesh"; }

[[noreturn]] void refuseAt(const XmlTag& tag, const std::string& xml, const std::string& source, const char* what) {
  throw std::invalid_argument(source + ":" + std::to_string(lineOf(xml, tag.position)) + ": " + what);
}

void checkText(const std::string& xml, const std::string& source) {
  if (xml.empty()) throw std::invalid_argument(source + ": the URDF is empty");
  if (xml.size() > kMaxUrdfBytes) {
    throw std::invalid_argument(source + ": the URDF has " + std::to_string(xml.size()) + " bytes; at most " +
                                std::to_string(kMaxUrdfBytes) + " are read");
  }
  const std::size_t zero = xml.find('\0');
  if (zero != std::string::npos) {
    throw std::invalid_argument(source + ":" + std::to_string(lineOf(xml, zero)) +
                                ": malformed XML: a zero byte; is this a text file?");
  }
  checkXmlNesting(xml, source, kMaxXmlDepth);
  std::size_t links = 0;
  int shapes = 0;  // of the last <geometry>
  bool is_root = true;
  std::vector<std::string_view> open;
  XmlTagScanner scanner(xml);
  for (XmlTag tag; scanner.next(tag);) {
    if (std::exchange(is_root, false) && tag.name != "robot") {
      throw std::invalid_argument(source + ": its outermost element is <" + printable(std::string(tag.name)) +
                                  ">, and that of a URDF is <robot>: convert it, if it is SDF or MJCF");
    }
    if (tag.kind == XmlTag::Kind::kClose) {
      if (!open.empty()) open.pop_back();
      continue;
    }
    links += tag.name == "link" ? 1 : 0;
    if (tag.name == "geometry") shapes = 0;
    if (isShape(tag.name)) ++shapes;
    const auto isWithin = [&](std::size_t up, std::string_view name) {
      return open.size() > up && open[open.size() - 1 - up] == name;
    };
    // What urdfdom leaves out without a word.
    if (tag.name == "link" && isWithin(0, "link"))
      refuseAt(tag, xml, source, "a <link> within a <link> is not read; move it out");
    if (shapes > 1 && isShape(tag.name) && isWithin(0, "geometry") && isWithin(1, "collision") && isWithin(2, "link")) {
      refuseAt(tag, xml, source, "a second shape in a <geometry> is not read; give it a <collision> of its own");
    }
    if (tag.kind == XmlTag::Kind::kOpen) open.push_back(tag.name);
  }
  if (links > kMaxLinks) {
    throw std::invalid_argument(source + ": the URDF has " + std::to_string(links) + " links; at most " +
                                std::to_string(kMaxLinks) + " are read");
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr parseWithUrdfdom(const std::string& xml, const std::string& source) {
  checkText(xml, source);
  CapturedErrors captured;
  urdf::ModelInterfaceSharedPtr model;
  std::string reason;
  try {
    // TinyXML 2.6.2 loops for ever on a text that ends inside a byte-order mark (CVE-2021-42260); blank lines prevent
    // it.
    model = urdf::parseURDF(xml + "\n\n\n");
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (model && !captured.lostSomething()) return model;
  if (!captured.errors().empty()) reason += (reason.empty() ? "" : "; ") + captured.errors();
  if (reason.empty()) reason = "no reason given";
  if (reason.find("no known type") != std::string::npos) {
    reason +=
        "; a joint is fixed, revolute, continuous or prismatic here (one like a ball: three revolute joints in a row)";
  }
  throw std::invalid_argument(source + ": urdfdom refuses this URDF: " + printable(reason, kMaxReasonLength) +
                              "; correct or delete what it names, which check_urdf finds as well");
}

}  // namespace tissue_contact
