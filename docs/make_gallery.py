#!/usr/bin/env python3
"""Writes docs/gallery.md and scenes/examples/README.md from the scenes themselves.

Usage: docs/make_gallery.py [--measure] [STRIDOR]

What a card says stands in the comment at the top of its scene. With --measure every command is run
as printed, its processor time kept in docs/figures/gallery/times.json, and the pictures are drawn
anew by `stridor draw` (takes python3-pil and about two minutes); without it, both are kept.
"""
import json
import pathlib
import re
import resource
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent
PICTURES = HERE / "figures" / "gallery"
TIMES = PICTURES / "times.json"

GROUPS = {
    "First steps": ["examples/mass_on_belt", "examples/two_springs_on_a_belt", "beam_on_beam",
                    "examples/ruler", "examples/stick_slip", "examples/landing"],
    "Transients": ["beam_on_beam_leading", "beam_on_beam_limit_cycle", "examples/frozen_growth",
                   "examples/rough_surface", "examples/clamped_bridge", "examples/continued",
                   "examples/pinned_with_tables", "examples/two_pairs", "examples/two_feet",
                   "examples/slave_edge", "examples/thrown_bar", "examples/opposite_drives",
                   "examples/stick_slip_cycle"],
    "Stability": ["examples/flutter", "examples/flutter_equal_damping", "examples/flutter_ziegler",
                  "examples/flutter_gyroscopic", "examples/gyroscopic",
                  "examples/rotating_support"],
    "Discs and pads": ["disc_and_pads", "examples/disc_squeal", "examples/elastic_pads",
                       "examples/meshed_disc"],
    "Rubber": ["viscoelastic_contact", "viscoelastic_sphere", "examples/sphere_on_rubber",
               "examples/beam_on_substrate"],
    "Meshes, matrices and measured parts": [
        "examples/bracket", "examples/sliding_block", "examples/tuning_fork", "examples/reed",
        "examples/from_calculix", "examples/from_abaqus", "examples/from_ansys",
        "examples/from_nastran"],
}


class Card:
    """What the top of a scene says: a description, commands, and what to look at."""

    def __init__(self, name):
        self.name = name
        self.stem = name.split("/")[-1]
        self.path = f"scenes/{name}.yaml"
        text = (SOURCE / self.path).read_text(encoding="utf-8")
        comment = []
        for line in text.splitlines():
            if not line.startswith("#"):
                break
            if "yaml-language-server" not in line:
                comment.append(line[1:])
        paragraphs = [" ".join(part.split("\n")) for part in "\n".join(comment).split("\n\n")]
        self.commands = [line.strip() for line in comment if line.strip().startswith("stridor ")]
        prose = [re.sub(r"\s+", " ", part).strip() for part in paragraphs if "   stridor " not in part]
        self.description = prose[0]
        self.look = " ".join(prose[1:])
        self.expected = re.findall(
            r"^  - \{result: \"?([^,\"]+)\"?, value: ([^,]+), tolerance: ([^}]+)\}", text, re.M)

    @property
    def needed(self):
        """Commands that make files which the scene takes: those before the first of its own."""
        needed = []
        for one in self.commands:
            if self.path in one:
                return needed
            needed.append(one)
        return []

    @property
    def command(self):
        own = [one for one in self.commands
               if self.path in one and not one.startswith("stridor draw")]
        return own[0] if own else f"stridor run {self.path} -o {self.stem}.h5 --verify"

    @property
    def sentence(self):
        """The first sentence of the description."""
        return re.split(r"(?<=[a-z0-9)\]])\. (?=[A-Z])", self.description)[0].rstrip(".") + "."


def cards():
    listed = [name for names in GROUPS.values() for name in names]
    found = [str(path.relative_to(SOURCE / "scenes"))[:-5]
             for folder in ("scenes", "scenes/examples")
             for path in (SOURCE / folder).glob("*.yaml")]
    if sorted(listed) != sorted(found):
        sys.exit(f"GROUPS and scenes differ: {sorted(set(listed) ^ set(found))}")
    return {name: Card(name) for name in listed}


def seconds_of(command, stridor, folder):
    """Processor time of a command in a folder that has the scenes beside it."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = shlex.split(command)
    subprocess.run([stridor, *words[1:]], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def draw(card, stridor, folder):
    """A small picture of the scene, where there is something to draw."""
    from PIL import Image

    large = folder / "large.png"
    drawn = subprocess.run([stridor, "draw", card.path, "-o", large, "--force"], cwd=folder,
                           capture_output=True)
    if drawn.returncode != 0:
        return
    picture = Image.open(large).convert("RGB")
    height = 480 * picture.height // picture.width
    picture = picture.resize((480, height), Image.Resampling.LANCZOS).quantize(32)
    picture.save(PICTURES / f"{card.stem}.png", optimize=True)


def measure(all_cards, stridor):
    PICTURES.mkdir(exist_ok=True)
    times = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run(["cp", "-r", SOURCE / "scenes", folder / "scenes"], check=True)
        for card in all_cards.values():
            for command in card.needed:
                seconds_of(command, stridor, folder)
            times[card.name] = round(seconds_of(card.command, stridor, folder), 2)
            print(f"{times[card.name]:8.2f} s  {card.command}", flush=True)
            draw(card, stridor, folder)
    TIMES.write_text(json.dumps(times, indent=1) + "\n", encoding="utf-8")


def shown(seconds):
    return f"{seconds:.1f} s" if seconds >= 0.1 else "below 0.1 s"


def gallery(all_cards, times):
    lines = ["# Gallery", "",
             "Every scene of the tree, with what it shows and the command to begin with, run from the folder that",
             "holds `scenes`. Times are processor times of that command, measured by `docs/make_gallery.py --measure`,",
             "which writes this page. Reference values are those of the scene's `expect:` block, which `--verify` and",
             "the tests compare.", ""]
    for group, names in GROUPS.items():
        lines += [f"## {group}", ""]
        for name in names:
            card = all_cards[name]
            lines += [f"### {card.stem}", ""]
            if (PICTURES / f"{card.stem}.png").exists():
                lines += [f"![Drawing of {card.stem}](figures/gallery/{card.stem}.png)", ""]
            lines += [card.description, ""]
            if card.look:
                lines += [card.look, ""]
            lines += ["```sh", *card.needed, card.command, "```", "",
                      f"[`{card.path}`](../{card.path}), {shown(times[name])}"]
            if card.expected:
                values = "; ".join(f"`{result}` {value} ± {tolerance}"
                                   for result, value, tolerance in card.expected)
                lines[-1] += f". Reference: {values}"
            lines[-1] += "."
            lines.append("")
    return "\n".join(lines)


def index(all_cards, times):
    lines = ["# Scenes", "",
             "A scene for every feature, in the order of [the gallery](../../docs/gallery.md), which has pictures and",
             "reference values. Commands are run from the folder that holds `scenes`. Written by `docs/make_gallery.py`.", ""]
    for group, names in GROUPS.items():
        lines += [f"## {group}", "", "| scene | what it is | command | processor time |", "|---|---|---|---|"]
        for name in names:
            card = all_cards[name]
            link = f"{card.stem}.yaml" if name.startswith("examples/") else f"../{card.stem}.yaml"
            sentence = card.sentence.replace("|", "\\|")
            lines.append(f"| [`{card.stem}`]({link}) | {sentence} | `{card.command}` | {shown(times[name])} |")
        lines.append("")
    return "\n".join(lines)


def main():
    arguments = sys.argv[1:]
    all_cards = cards()
    if "--measure" in arguments:
        arguments.remove("--measure")
        stridor = pathlib.Path(arguments[0] if arguments else SOURCE / "build/release/stridor")
        measure(all_cards, stridor.resolve())
    times = json.loads(TIMES.read_text(encoding="utf-8"))
    (HERE / "gallery.md").write_text(gallery(all_cards, times), encoding="utf-8")
    (SOURCE / "scenes/examples/README.md").write_text(index(all_cards, times), encoding="utf-8")


if __name__ == "__main__":
    main()
