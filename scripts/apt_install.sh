#!/bin/sh
# apt_install.sh PACKAGE WHY: install a Debian package when we may (root, apt-get), else say so and fail.
package=$1
why=$2
if ! command -v apt-get >/dev/null || [ "$(id -u)" -ne 0 ]; then
    echo "$why Please install $package (on Debian and Ubuntu: sudo apt-get install $package)."
    exit 1
fi
echo "$why Installing $package."
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq && apt-get install -qq --yes --no-install-recommends "$package" >/dev/null && exit 0
echo "$why apt-get could not install $package."
exit 1
