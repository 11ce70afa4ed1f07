#include "ros/number_parameter.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <sstream>
#include <stdexcept>

#include "tissue_contact/core/text.h"

namespace tissue_contact {

double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, const Range& range) {
  double value = otherwise;
  const std::string what = "parameter '" + node.resolveName(name) + "'";
  XmlRpc::XmlRpcValue given;
  if (node.getParam(name, given) && !node.getParam(name, value)) {
    std::ostringstream text;
    text << given;
    throw std::invalid_argument(what + " is " + inQuotes(text.str()) + "; it must be a number " + range.text());
  }
  return range.require(what, value);
}

}  // namespace tissue_contact
