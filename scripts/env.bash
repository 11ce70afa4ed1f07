# Source this file (bash): rosrun, roslaunch and rostest then find what scripts/build has built. Needs no catkin workspace.
# Leaves every other ROS workspace, but files of packages that ROS_PACKAGE_PATH named are found still (package://), after its own; system
# packages need no environment on Debian 12.
_tissue_contact_setup="$("$(dirname "${BASH_SOURCE[0]}")/build" --where)/devel/setup.bash"
if [ ! -f "$_tissue_contact_setup" ]; then
  echo "tissue_contact is not built yet: run scripts/build first" >&2
  unset _tissue_contact_setup
  return 1
fi

_tissue_contact_nounset=; case $- in *u*) _tissue_contact_nounset=1; set +u ;; esac  # catkin's file fails under it
_tissue_contact_packages="${ROS_PACKAGE_PATH:-}"
unset PYTHONHOME PYTHONPATH CMAKE_PREFIX_PATH ROS_PACKAGE_PATH
case ":$PATH:" in :/usr/bin:*) ;; *) export PATH="/usr/bin:$PATH" ;; esac  # the system's python3 has ROS, another has not
. "$_tissue_contact_setup" ""  # without arguments it would take those of the script that sources this
while [ -n "$_tissue_contact_packages" ]; do
  _tissue_contact_folder="${_tissue_contact_packages%%:*}"
  _tissue_contact_packages="${_tissue_contact_packages#"$_tissue_contact_folder"}" _tissue_contact_packages="${_tissue_contact_packages#:}"
  case ":$ROS_PACKAGE_PATH:" in *:"$_tissue_contact_folder":*) ;; *) export ROS_PACKAGE_PATH="$ROS_PACKAGE_PATH:$_tissue_contact_folder" ;; esac
done
export ROS_MASTER_URI="${ROS_MASTER_URI:-http://localhost:11311}"
[ -n "${ROS_IP:-}" ] || export ROS_HOSTNAME="${ROS_HOSTNAME:-localhost}"  # a host name that does not resolve stops every node
export PYTHONUNBUFFERED=1 ROSCONSOLE_STDOUT_LINE_BUFFERED=1               # logs appear at once, tty or not
[ -z "$_tissue_contact_nounset" ] || set -u
unset _tissue_contact_setup _tissue_contact_nounset _tissue_contact_packages _tissue_contact_folder
