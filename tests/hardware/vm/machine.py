# SPDX-License-Identifier: Apache-2.0
"""Boots the test machine and runs one shell script in it.

QEMU by interpretation (TCG): KVM is not there in containers and hung when nested. The machine sees the host's files
read-only, so that the binaries under test run as they were built.
"""
import os
import subprocess
import tempfile
import time

from kernel import need

# no_timer_check: the kernel's boot test of the timer interrupt fails by chance on a busy host.
KERNEL_WORDS = ("console=ttyS0 quiet loglevel=4 panic=-1 mitigations=off no_timer_check tsc=reliable clocksource=tsc "
                "random.trust_cpu=on")
BOOT_TIMEOUT_S = 120
BOOT_TRIES = 3
UP = "vm: up"  # said by init on the console


class Machine:
    def __init__(self, kernel, memory_mib=1024, processors=2):
        self.kernel = kernel
        self.memory_mib = memory_mib
        self.processors = processors
        self.qemu = need("qemu-system-x86_64", "qemu-system-x86")

    def run(self, script, job, timeout_s, systemd=False):
        """(exit code or None, the kernel's console): the script's output is copied to stdout as it comes.

        With systemd, that is PID 1 and the script one of its services.
        """
        (job / "job.sh").write_text(script)
        for tries in range(1, BOOT_TRIES + 1):
            is_up, code, console = self.boot(job, timeout_s, systemd)
            if is_up:
                break
            print("try %d: the machine did not boot; its console ended with: %s" % (tries, console[-300:].strip()))
        return code, console

    def boot(self, job, timeout_s, systemd):
        """(whether the script began, exit code or None, the console) of one boot."""
        for name in ("out", "code", "console"):
            (job / name).write_bytes(b"")
        out = job / "out.fifo"
        out.unlink(missing_ok=True)
        os.mkfifo(out)
        share = "local,security_model=none"
        command = [
            self.qemu, "-machine", "q35,usb=off,vmport=off,smbus=off,hpet=off", "-accel", "tcg,thread=multi", "-cpu", "max",
            "-m", str(self.memory_mib), "-smp", str(self.processors), "-no-user-config", "-nodefaults", "-display", "none",
            "-no-reboot", "-kernel", str(self.kernel.image), "-initrd", str(self.kernel.initramfs),
            "-append", KERNEL_WORDS + " vmjob=%s%s" % (job, " vmsystemd systemd.show_status=0" if systemd else ""),
            "-chardev", "file,id=console,path=%s" % (job / "console"), "-serial", "chardev:console",
            "-device", "virtio-serial-pci",
            "-chardev", "file,id=out,path=%s" % out, "-device", "virtserialport,chardev=out,name=out",
            "-chardev", "file,id=code,path=%s" % (job / "code"), "-device", "virtserialport,chardev=code,name=code",
            "-fsdev", "%s,id=root,path=/,readonly=on,multidevs=remap" % share, "-device", "virtio-9p-pci,fsdev=root,mount_tag=hostroot",
            "-fsdev", "%s,id=job,path=%s" % (share, job), "-device", "virtio-9p-pci,fsdev=job,mount_tag=hostjob",
            "-object", "rng-random,id=rng,filename=/dev/urandom", "-device", "virtio-rng-pci,rng=rng",
        ]
        # Held open for writing here, so that the reader below sees no end before the machine is gone.
        keeper = os.open(out, os.O_RDWR)
        copier = subprocess.Popen(["cat", str(out)])
        with tempfile.TemporaryFile() as complaints:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=complaints, stderr=subprocess.STDOUT)
            ended = self.wait(process, job / "console", timeout_s)
            os.close(keeper)
            copier.wait()
            complaints.seek(0)
            said = complaints.read().decode(errors="replace").strip()
        code = (job / "code").read_text().strip()
        console = (job / "console").read_text(errors="replace")
        is_up = UP in console
        if not ended:
            console += "\nthe machine did not %s in time" % ("end" if is_up else "boot")
        if said:
            console += "\nqemu: " + said
        return is_up, (int(code) if code.isdigit() else None), console

    def wait(self, process, console, timeout_s):
        """False where it had to be killed: it did not boot, or not end, in time."""
        began = time.monotonic()
        limit = BOOT_TIMEOUT_S
        while True:
            try:
                process.wait(1)
                return True
            except subprocess.TimeoutExpired:
                if UP in console.read_text(errors="replace"):
                    limit = timeout_s
            if time.monotonic() - began > limit:
                process.kill()
                process.wait()
                return False
