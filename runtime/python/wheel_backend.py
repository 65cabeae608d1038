# SPDX-License-Identifier: MIT
"""Makes the wheel for pip: the package, and libgic from the build folder (GICGEN_LIBRARY: from there)."""
import base64
import hashlib
import os
import re
import sysconfig
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
TIME = (1980, 1, 1, 0, 0, 0)  # the same input, the same bytes


def _version():
    with open(os.path.join(HERE, "..", "..", "generator", "base", "version.h")) as file:
        return re.search(r'GICGEN_VERSION "(.*)"', file.read())[1]


def _platform():
    return re.sub(r"[-.]", "_", sysconfig.get_platform())


def _metadata():
    return f"Metadata-Version: 2.1\nName: gicgen\nVersion: {_version()}\nRequires-Dist: numpy\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    library = os.environ.get("GICGEN_LIBRARY") or os.path.join(HERE, "..", "..", "build", "libgic.so")
    if not os.path.exists(library):
        raise SystemExit(f"gicgen: {library} is not there\n  remedy: run `make` first, or set GICGEN_LIBRARY")
    tag = f"py3-none-{_platform()}"
    folder = f"gicgen-{_version()}.dist-info"
    files = {}
    package = os.path.join(HERE, "gicgen")
    for name in sorted(os.listdir(package)):
        if name.endswith(".py"):
            with open(os.path.join(package, name), "rb") as file:
                files["gicgen/" + name] = file.read()
    with open(library, "rb") as file:
        files["gicgen/libgic.so"] = file.read()
    files[folder + "/METADATA"] = _metadata().encode()
    files[folder + "/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: gicgen\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[folder + "/RECORD"] = (record + f"{folder}/RECORD,,\n").encode()
    wheel = f"gicgen-{_version()}-{tag}.whl"
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as out:
        for name, data in files.items():
            info = zipfile.ZipInfo(name, TIME)
            info.external_attr = 0o644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            out.writestr(info, data)
    return wheel
