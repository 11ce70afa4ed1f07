#include "ros/parameter.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <sstream>
#include <stdexcept>

#include "tissue_contact/core/text.h"

namespace tissue_contact {

double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, const Range& range) {
  double value = otherwise;
  const std::string what = "parameter '" + node.resolveName(name) + "'";
  std::ostringstream fix;
  fix << "default " << otherwise << (*range.fix == '\0' ? "" : "; ") << range.fix;
  XmlRpc::XmlRpcValue given;
  if (node.getParam(name, given) && !node.getParam(name, value)) {
    std::ostringstream text;
    text << given;
    throw std::invalid_argument(what + " is " + inQuotes(text.str()) + "; it must be a number " + range.text() + "; " +
                                fix.str());
  }
  const std::string told = fix.str();
  Range with_default = range;
  with_default.fix = told.c_str();
  return with_default.require(what, value);
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
