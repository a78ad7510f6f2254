"""Screenshots of pages by headless Chromium."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
"""Path of a Chromium, or None where the machine has none."""

_FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    "--enable-logging=stderr",
)

# A frame has the size that is asked for; a window loses some to its border, and is never narrower than 500.
# Chromium takes the picture when all is loaded: a second frame is, once the page is through its steps.
_FRAME = """<!doctype html><meta name="color-scheme" content="light dark">
<style>iframe {{ position: fixed; top: 0; left: 0; border: 0; width: {width}px; height: {height}px }}</style>
<iframe src="page.html"></iframe>
<iframe id="pending" hidden></iframe>
<script>pending.contentDocument.open(); onmessage = () => pending.contentDocument.close();</script>
"""
_STEPS = """<script>addEventListener("load", async () => {{
  const drawn = () => new Promise(done => requestAnimationFrame(() => setTimeout(done, 60)));
  try {{
    for (const step of [{steps}]) {{ await drawn(); step(); }}
    for (let frame = 0; frame < 4; frame++) await drawn();
  }} finally {{ parent.postMessage("done", "*"); }}
}});</script>
"""
_BORDER = 300


def take_picture(
    page: Path,
    picture: Path,
    *,
    width: int,
    height: int,
    steps: Sequence[str] = (),
    dark: bool = False,
    scale: int = 1,
) -> None:
    """Takes a picture of a page.

    Args:
        page: HTML file.
        picture: PNG file to be written.
        width: of what is seen, CSS pixels.
        height: of what is seen, CSS pixels.
        steps: expressions of the page run before, one after another.
        dark: colour scheme.
        scale: pixels of the picture in a CSS pixel.
    """
    assert CHROMIUM is not None
    functions = ",".join(f"() => {{ {step} }}" for step in steps)
    with TemporaryDirectory() as name:
        folder, written = Path(name), Path(name) / "picture.png"
        (folder / "page.html").write_text(page.read_text(encoding="utf-8") + _STEPS.format(steps=functions))
        (folder / "frame.html").write_text(_FRAME.format(width=width, height=height))
        command = [
            *(CHROMIUM, *_FLAGS, f"--user-data-dir={folder / 'profile'}", f"--screenshot={written}"),
            *(f"--window-size={width + _BORDER},{height + _BORDER}", f"--force-device-scale-factor={scale}"),
            *(["--blink-settings=preferredColorScheme=0"] if dark else []),
            (folder / "frame.html").as_uri(),
        ]
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
        complaints = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
        assert not complaints, (picture.name, complaints)
        with Image.open(written) as whole:
            whole.crop((0, 0, width * scale, height * scale)).save(picture)
