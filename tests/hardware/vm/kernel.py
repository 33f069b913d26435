# SPDX-License-Identifier: Apache-2.0
"""Debian's stock kernel for the test machine: fetched into the build tree, unpacked, never installed.

The virtual cameras (vivid) and the file systems of the machine are modules of this package; the machine that builds
needs none of them.
"""
import lzma
import os
import shutil
import struct
import subprocess
from pathlib import Path

# In this order; depmod's dependencies are added before each.
BOOT_MODULES = ("virtio_pci", "virtio_console", "9pnet_virtio", "9p", "overlay")


class Missing(Exception):
    """Something that this machine does not have: a reason to skip, no failure."""


def run(*command, **options):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options).stdout


def need(program, package):
    # depmod, modprobe and the like live outside a plain user's path.
    path = shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
    if not path:
        raise Missing("%s is missing (Debian package %s)" % (program, package))
    return path


def package_name():
    need("apt-cache", "apt")
    try:
        lines = run("apt-cache", "depends", "linux-image-amd64").splitlines()
    except subprocess.CalledProcessError:
        lines = []
    for line in lines:
        if "Depends:" in line and "linux-image-" in line:
            return line.split(":")[1].strip()
    raise Missing("apt knows no linux-image-amd64 (apt-get update; Debian on amd64)")


def unpacked_package(folder, name):
    """The package's files under folder/name; downloaded once."""
    root = folder / name
    if (root / "complete").exists():
        return root
    need("apt-get", "apt")
    need("dpkg", "dpkg")
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir(parents=True)
    try:
        run("apt-get", "download", name, cwd=root)
    except subprocess.CalledProcessError as error:
        raise Missing("cannot download %s: %s" % (name, error.stderr.strip().splitlines()[-1:])) from error
    archive = next(root.glob("*.deb"))
    run("dpkg", "-x", str(archive), str(root / "root"))
    archive.unlink()
    (root / "complete").touch()
    return root


def uncompressed(bzimage):
    """The ELF image inside a bzImage (its place stands in the setup header), which an emulator boots faster."""
    data = bzimage.read_bytes()
    setup_sectors = data[0x1F1]
    offset, length = struct.unpack("<II", data[0x248:0x250])
    begin = (setup_sectors + 1) * 512 + offset
    payload = data[begin:begin + length]
    if not payload.startswith(b"\xfd7zXZ\x00"):
        raise Missing("the kernel is not packed as xz; teach tests/hardware/vm/kernel.py this packing")
    return lzma.LZMADecompressor().decompress(payload)


def initramfs(root, version, folder, init):
    busybox = need("busybox", "busybox-static")
    if b"ld-linux" in Path(busybox).read_bytes()[:4096]:
        raise Missing("busybox is not static (Debian package busybox-static)")
    tree = folder / "initramfs"
    shutil.rmtree(tree, ignore_errors=True)
    for name in ("bin", "lib/modules", "proc", "sys", "dev", "mnt/lower", "mnt/upper", "mnt/root"):
        (tree / name).mkdir(parents=True)
    shutil.copy(busybox, tree / "bin/busybox")
    shutil.copy(init, tree / "init")
    (tree / "init").chmod(0o755)
    run(need("depmod", "kmod"), "-b", str(root), version)
    order = []
    for module in BOOT_MODULES:
        for line in run(need("modprobe", "kmod"), "-d", str(root), "-S", version, "--show-depends", module).splitlines():
            word, _, path = line.partition(" ")
            if word == "insmod" and path.strip() not in order:
                order.append(path.strip())
    for path in order:
        shutil.copy(path, tree / "lib/modules")
    (tree / "modules.order").write_text("".join(Path(path).name + "\n" for path in order))
    names = "\n".join(str(path.relative_to(tree)) for path in sorted(tree.rglob("*")))
    image = folder / "initramfs.img"
    with image.open("wb") as out:
        subprocess.run([need("cpio", "cpio"), "-o", "-H", "newc", "--quiet"], cwd=tree, input=names.encode(), stdout=out,
                       check=True)
    return image


class Kernel:
    """vmlinux, an initramfs and a folder of modules."""

    def __init__(self, build, init):
        self.build = build
        name = package_name()
        package = unpacked_package(build, name)
        self.root = package / "root"
        if not (self.root / "lib/modules").is_dir():
            raise Missing("%s holds no lib/modules" % name)
        self.version = next((self.root / "lib/modules").iterdir()).name
        self.image = package / "vmlinux"
        if not self.image.exists():
            part = package / "vmlinux.part"
            part.write_bytes(uncompressed(self.root / "boot" / ("vmlinuz-" + self.version)))
            part.rename(self.image)
        self.initramfs = initramfs(self.root, self.version, package, init)
