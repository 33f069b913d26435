# SPDX-License-Identifier: Apache-2.0
"""The virtual media controller camera (vimc), which libcamera knows and Debian's kernel does not build.

libcamera learns of cameras from udev, so the machine also gets Debian's udev, unpacked.

Built out of tree from Debian's kernel source against its kernel headers, all unpacked privately in the build tree.
Downloads some 150 MB, so only the long tests do it.
"""
import os
import shlex
import shutil
import subprocess

from kernel import Missing, need, run, unpacked_package


def private_headers(build, version):
    """Headers and build programs of the kernel, relocated: Debian's refer to each other by /usr paths."""
    common_name = "linux-headers-%s-common" % version.rsplit("-", 1)[0]
    own = unpacked_package(build, "linux-headers-" + version) / "root"
    common = unpacked_package(build, common_name) / "root"
    tools = unpacked_package(build, "linux-kbuild-" + ".".join(version.split(".")[:2])) / "root"
    headers = own / "usr/src" / ("linux-headers-" + version)
    common_headers = common / "usr/src" / common_name
    makefile = headers / "Makefile"
    makefile.write_text(makefile.read_text().replace("/usr/src/" + common_name, str(common_headers)))
    programs = next((tools / "usr/lib").glob("linux-kbuild-*"))
    for place in (headers, common_headers):
        for name in ("scripts", "tools"):
            link = place / name
            if link.is_symlink():
                link.unlink()
                link.symlink_to(programs / name)
    return headers


def add_vimc(kernel, build):
    """Puts vimc.ko beside the kernel's own modules."""
    place = kernel.root / "lib/modules" / kernel.version / "extra"
    if (place / "vimc.ko").exists():
        return
    for program, package in (("make", "make"), ("gcc", "gcc"), ("tar", "tar"), ("xz", "xz-utils")):
        need(program, package)
    series = ".".join(kernel.version.split(".")[:2])
    archive = unpacked_package(build, "linux-source-" + series) / "root/usr/src" / ("linux-source-%s.tar.xz" % series)
    folder = build / "vimc"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    inside = "linux-source-%s/drivers/media/test-drivers/vimc" % series
    run("tar", "-xJf", str(archive), "-C", str(folder), "--strip-components=5", inside)
    headers = private_headers(build, kernel.version)
    try:
        run("make", "-C", str(headers), "M=%s" % folder, "CONFIG_VIDEO_VIMC=m", "-j%d" % (os.cpu_count() or 1), "modules")
    except subprocess.CalledProcessError as error:
        raise Missing("vimc does not build:\n" + error.stderr[-2000:]) from error
    place.mkdir(exist_ok=True)
    shutil.copy(folder / "vimc.ko", place)
    run(need("depmod", "kmod"), "-b", str(kernel.root), kernel.version)


def udev_lines(build):
    """Shell lines that start udev in the machine and let it see the cameras."""
    root = unpacked_package(build, "udev") / "root"
    place = "udev=%s" % shlex.quote(str(root))
    return [place, "mkdir -p /lib/udev /lib/systemd /run/udev",
            "cp -a $udev/lib/udev/. /lib/udev/", "cp -a $udev/lib/systemd/systemd-udevd /lib/systemd/",
            "cp -a $udev/bin/udevadm /usr/bin/", "rm -f /run/udev/control",
            # The machine's root is changed into; udev must not mind.
            "export SYSTEMD_IGNORE_CHROOT=1",
            "/lib/systemd/systemd-udevd --daemon --resolve-names=never",
            "udevadm trigger --action=add --subsystem-match=media --subsystem-match=video4linux", "udevadm settle"]
