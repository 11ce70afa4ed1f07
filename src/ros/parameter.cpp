#include "ros/parameter.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <sstream>
#include <stdexcept>

#include "scene/yaml_reader.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

namespace {

/// @param otherwise told as the default.
std::optional<double> givenNumber(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise,
                                  const Range& range) {
  XmlRpc::XmlRpcValue given;
  if (!node.getParam(name, given)) return std::nullopt;
  const std::string what = "parameter '" + node.resolveName(name) + "'";
  const std::string fix = "default " + otherwise + (*range.fix == '\0' ? "" : "; ") + range.fix;
  double value = 0.0;
  if (!node.getParam(name, value)) {
    std::ostringstream text;
    given.write(text);
    throw std::invalid_argument(what + " is " + inQuotes(text.str()) + "; it must be a number " + range.text() + "; " +
                                fix);
  }
  Range with_default = range;
  with_default.fix = fix.c_str();
  return with_default.require(what, value);
}

}  // namespace

double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, const Range& range) {
  std::ostringstream told;
  told << otherwise;
  return givenNumber(node, name, told.str(), range).value_or(otherwise);
}

std::optional<double> numberParameter(const ros::NodeHandle& node, const std::string& name, const Range& range) {
  return givenNumber(node, name, "auto", range);
}

std::string textParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise) {
  std::string value = otherwise;
  XmlRpc::XmlRpcValue given;
  if (!node.getParam(name, given) || node.getParam(name, value)) return value;
  std::ostringstream text;
  given.write(text);
  return text.str();
}

std::vector<std::string> textsParameter(const ros::NodeHandle& node, const std::string& name) {
  XmlRpc::XmlRpcValue given;
  if (!node.getParam(name, given)) return {};
  const std::string what = "parameter '" + node.resolveName(name) + "'";
  std::vector<std::string> texts;
  if (given.getType() == XmlRpc::XmlRpcValue::TypeString) {
    const auto text = static_cast<std::string>(given);
    if (text.empty() || text.front() != '[') return {text};
    for (const YamlCursor& element : parseYaml(text, what).list(0)) texts.push_back(element.text());
    return texts;
  }
  if (node.getParam(name, texts)) return texts;
  std::ostringstream text;
  given.write(text);
  throw std::invalid_argument(what + " is " + inQuotes(text.str()) +
                              "; it must be a list of texts KEY=VALUE, or one of them; default: none");
}

}  // namespace tissue_contact
