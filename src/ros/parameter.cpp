#include "ros/parameter.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <sstream>
#include <stdexcept>

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
    text << given;
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
  text << given;
  return text.str();
}

}  // namespace tissue_contact
