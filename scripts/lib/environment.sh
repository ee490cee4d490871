# The environment that every script of this folder works in. To be sourced by bash; scripts/setup and scripts/lib/python do.
#
# Sets    sojourn_root, sojourn_venv, sojourn_ros (what rclpy is taken from)
# Offers  sojourn_ready (is the set-up done and up to date?), sojourn_say
#
# A sourced ROS 2 Jazzy is used as it is. Without one, or with another distribution sourced, our processes get the pinned
# wheels and none of the variables that would lead them to other copies. A process of another environment, as a node
# put in the place of one of ours may be, needs those variables as they were: SOJOURN_OUTER lists their names, and
# SOJOURN_OUTER_<name> holds the value of each that was set.

sojourn_root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

sojourn_say() { printf 'sojourn: %s\n' "$*" >&2; }

if [ -z "${SOJOURN_OUTER:-}" ]; then
    sojourn_outermost=yes
    export SOJOURN_OUTER="LD_LIBRARY_PATH PYTHONPATH PYTHONHOME AMENT_PREFIX_PATH COLCON_PREFIX_PATH CMAKE_PREFIX_PATH \
ROS_DISTRO ROS_VERSION ROS_PYTHON_VERSION RMW_IMPLEMENTATION _ROS_WHEELS_BOOTSTRAP_COMPLETE PYTHONDONTWRITEBYTECODE"
    for name in $SOJOURN_OUTER; do
        if [ -n "${!name+set}" ]; then export "SOJOURN_OUTER_$name=${!name}"; fi
    done
else
    sojourn_outermost=
fi

if [ "${ROS_DISTRO:-}" = jazzy ] && [ -n "${AMENT_PREFIX_PATH:-}" ] && python3 -c 'import rclpy' 2>/dev/null; then
    sojourn_ros="sourced, $AMENT_PREFIX_PATH"
    sojourn_venv=$sojourn_root/.venv-ros
else
    if [ -n "$sojourn_outermost" ] && [ "${ROS_DISTRO:-jazzy}" != jazzy ]; then
        sojourn_say "ROS 2 $ROS_DISTRO is sourced, Sojourn needs jazzy: its own processes use the wheels in .venv instead."
    elif [ -n "$sojourn_outermost" ] && [ -n "${ROS_DISTRO:-}" ]; then
        sojourn_say "ROS 2 jazzy is sourced, but python3 cannot import its rclpy: using the wheels in .venv instead."
    fi
    sojourn_ros=wheels
    sojourn_venv=$sojourn_root/.venv

    # Libraries of a sourced ROS 2, or of wheels elsewhere, would be loaded in place of ours.
    kept=
    IFS=: read -ra directories <<<"${LD_LIBRARY_PATH:-}"
    for directory in ${directories[@]+"${directories[@]}"}; do
        case :${AMENT_PREFIX_PATH:-}: in *:"${directory%/lib*}":*) continue ;; esac
        case $directory in '' | /opt/ros/* | */site-packages/ros_*.libs) continue ;; esac
        kept=${kept:+$kept:}$directory
    done
    unset $SOJOURN_OUTER
    if [ -n "$kept" ]; then export LD_LIBRARY_PATH=$kept; fi
    export RMW_IMPLEMENTATION=rmw_fastrtps_cpp # the only one among the wheels
    unset kept directory directories
fi

# Containers set it: each process of a run would compile all our modules anew.
unset PYTHONDONTWRITEBYTECODE

# What each step of the set-up was done for; a step is up to date where its stamp says the same.
sojourn_fingerprint() {
    (
        cd "$sojourn_root"
        case $1 in
            dependencies)
                echo "$sojourn_root" "$sojourn_ros" "$(readlink -f "$sojourn_venv/bin/python")"
                cat requirements*.lock
                ;;
            packages)
                echo src/*/setup.py
                cat src/*/setup.py src/*/setup.cfg
                ;;
            kernels) grep -rlZE --include='*.py' 'sojourn_machine\.kernels|njit|IntEnum|compiled into kernels' src | sort -z | xargs -0r sha256sum ;; # with their names
        esac
    ) | sha256sum
}

sojourn_step_is_done() {
    [ -f "$sojourn_venv/sojourn/$1" ] && [ "$(sojourn_fingerprint "$1")" = "$(<"$sojourn_venv/sojourn/$1")" ]
}

sojourn_ready() {
    sojourn_unchanged && return
    local mark="$sojourn_venv/ready.$$"
    # before the look, and a second early: what changes meanwhile, or within the grain of the clock, is looked at again
    { sojourn_circumstances >"$mark" && touch --date='1 second ago' "$mark"; } 2>/dev/null || true
    if [ -x "$sojourn_venv/bin/python" ] && sojourn_step_is_done dependencies && sojourn_step_is_done packages &&
        sojourn_step_is_done kernels; then
        mv "$mark" "$sojourn_venv/ready" 2>/dev/null || true
    else
        rm -f "$mark"
        return 1
    fi
}

# Has nothing changed since everything was found up to date? The time of a file's last change (ctime) is asked for, which
# copying and unpacking cannot set back; a folder's tells of what was added, removed or renamed in it.
sojourn_unchanged() {
    local mark="$sojourn_venv/ready" changed
    [ -f "$mark" ] && [ -x "$sojourn_venv/bin/python" ] && [ "$(sojourn_circumstances)" = "$(<"$mark")" ] || return 1
    changed=$(cd "$sojourn_root" && find requirements*.lock src "$sojourn_venv/sojourn" -name __pycache__ -prune -o \
        \( -type d -o -name '*.py' -o -name '*.cfg' -o -name '*.lock' \) -cnewer "$mark" -print -quit 2>&1) &&
        [ -z "$changed" ]
}

sojourn_circumstances() {
    (
        cd "$sojourn_root"
        echo "$sojourn_root" "$sojourn_ros" "$(readlink -f "$sojourn_venv/bin/python")" requirements*.lock
    )
}
