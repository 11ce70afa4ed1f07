#include "check_dae.h"

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "xml_tags.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMaxXmlDepth = 256;
constexpr int kMaxExpandedDepth = 256;
constexpr int kMaxExpandedNodes = 100000;

/// The <node> elements of a file and what each contains.
struct DaeNode {
  std::string name;                    ///< for messages
  std::vector<std::size_t> children;   ///< <node> elements directly inside
  std::vector<std::string> instances;  ///< ids that its <instance_node> elements copy
};

class DaeNodes {
 public:
  DaeNodes(std::string_view xml, const std::string& source) : source_(source) {
    std::vector<std::size_t> open;
    std::vector<std::string_view> open_tags;
    XmlTagScanner scanner(xml);
    for (XmlTag tag; scanner.next(tag);) {
      if (tag.kind == XmlTag::Kind::kClose) {
        if (!open_tags.empty() && open_tags.back() == "node") open.pop_back();
        if (!open_tags.empty()) open_tags.pop_back();
        continue;
      }
      if (tag.name == "node") {
        const std::size_t node = addNode(tag);
        if (open.empty()) roots_.push_back(node);
        if (!open.empty()) nodes_[open.back()].children.push_back(node);
        if (tag.kind == XmlTag::Kind::kOpen) open.push_back(node);
      } else if (tag.name == "instance_node" && !open.empty()) {
        nodes_[open.back()].instances.push_back(target(tag));
      }
      if (tag.kind == XmlTag::Kind::kOpen) open_tags.push_back(tag.name);
    }
  }

  void checkExpansion() {
    for (const std::size_t root : roots_) expand(root, 0);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw std::invalid_argument(source_ + ": " + what); }

  std::size_t addNode(const XmlTag& tag) {
    nodes_.emplace_back();
    // assimp finds the target of an instance by id or by name.
    for (const char* key : {"name", "id"}) {
      const std::string value(xmlAttribute(tag, key));
      if (value.empty()) continue;
      nodes_.back().name = value;
      by_name_[value].push_back(nodes_.size() - 1);
    }
    return nodes_.size() - 1;
  }

  std::string target(const XmlTag& tag) const {
    const std::string url(xmlAttribute(tag, "url"));
    // Escaped characters would hide from this check which node is meant.
    if (url.size() < 2 || url[0] != '#' || url.find_first_of("&%") != std::string::npos) {
      refuse("<instance_node> has the url '" + url + "'; only \"#<id of a node of this file>\" is supported");
    }
    return url.substr(1);
  }

  void expand(std::size_t index, int depth) {
    const DaeNode& node = nodes_[index];
    if (depth > kMaxExpandedDepth) {
      refuse("node '" + node.name + "' contains itself through <instance_node>, or nests more than " +
             std::to_string(kMaxExpandedDepth) + " levels deep");
    }
    if (++expanded_ > kMaxExpandedNodes) {
      refuse("the copies made by <instance_node> amount to more than " + std::to_string(kMaxExpandedNodes) + " nodes");
    }
    for (const std::size_t child : node.children) expand(child, depth + 1);
    for (const std::string& name : node.instances) {
      const auto found = by_name_.find(name);
      if (found == by_name_.end()) continue;  // assimp warns and leaves it out
      for (const std::size_t copied : found->second) expand(copied, depth + 1);
    }
  }

  std::string source_;
  std::vector<DaeNode> nodes_;
  std::vector<std::size_t> roots_;
  std::map<std::string, std::vector<std::size_t>> by_name_;
  int expanded_ = 0;
};

}  // namespace

void checkDae(const std::string& xml, const std::string& source) {
  checkXmlNesting(xml, source, kMaxXmlDepth);
  DaeNodes(xml, source).checkExpansion();
}

}  // namespace tissue_contact
