# SPDX-License-Identifier: Apache-2.0
"""Boots the test machine and runs one shell script in it.

QEMU by interpretation (TCG): KVM is not there in containers and hung when nested. The machine sees the host's files
read-only, so that the binaries under test run as they were built.
"""
import os
import subprocess
import tempfile

from kernel import need


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
            "-append", "console=ttyS0 quiet loglevel=4 panic=-1 mitigations=off tsc=reliable random.trust_cpu=on vmjob=%s%s" % (job, " vmsystemd systemd.show_status=0" if systemd else ""),
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
            try:
                process.wait(timeout_s)
                ended = True
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                ended = False
            os.close(keeper)
            copier.wait()
            complaints.seek(0)
            said = complaints.read().decode(errors="replace").strip()
        code = (job / "code").read_text().strip()
        console = (job / "console").read_text(errors="replace")
        if not ended:
            console += "\nthe machine did not end within %d s" % timeout_s
        if said:
            console += "\nqemu: " + said
        return (int(code) if code.isdigit() else None), console


