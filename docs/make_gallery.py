#!/usr/bin/env python3
"""Writes docs/gallery.md and scenes/examples/README.md from the scenes themselves.

Usage: docs/make_gallery.py [--measure | --pictures | --check] [STRIDOR]

What a card says stands in the comment at the top of its scene, how its result is shown in RESULTS.
Reference values are those of its `expect:` block, else of REFERENCES, which --check compares with what
the program finds (all but those that take long). Of the extreme scenes their heads say what they stress.
With --measure every command is run as printed, the processor time of the first one kept in
docs/figures/gallery/times.json, and the pictures are drawn anew, of the scene by `stridor draw` and
of its result by the commands printed (takes python3-pil and about two minutes). With --pictures the
times are kept, without either the pictures too.
"""
import json
import math
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
LARGEST = 30000  # bytes of a picture, where 16 colours are enough for that

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
                       "examples/meshed_disc", "examples/brake/brake"],
    "Rubber": ["viscoelastic_contact", "viscoelastic_sphere", "examples/sphere_on_rubber",
               "examples/beam_on_substrate"],
    "Meshes, matrices and measured parts": [
        "examples/bracket", "examples/sliding_block", "examples/tuning_fork", "examples/reed",
        "examples/from_calculix", "examples/from_abaqus", "examples/from_ansys",
        "examples/from_nastran"],
}

EXTREME = "Extreme cases"

# How the result of a scene is shown: what kind of picture it is, what is seen in it, and the commands
# that make it after the one of the card, or none where that makes it. {path} is the scene, {stem} its
# name, {file} what the command of the card writes.
RESULTS = {
    "examples/mass_on_belt": (
        "Limit cycle",
        "Velocity against displacement: the mass sticks to the belt of 0.1 m/s from 20 to 40 mm and slips back"
        " along an ellipse.",
        ["stridor plot {file} --kind phase --channel slider.mass.x.displacement -o {stem}.png"]),
    "examples/two_springs_on_a_belt": (
        "Root locus",
        "Growth rates and frequencies over µ: the two frequencies meet at 0.75, beyond which one motion grows.",
        ["stridor locus {path} --parameter parameters.mu --from 0 --to 1.2 --points 241 --history {stem}.png"]),
    "beam_on_beam": (
        "Spectrogram",
        "The frequencies of the modes wander as the contact moves along the cantilever; bursts near 3.53 and"
        " 10.6 kHz.",
        ["stridor spectrogram {file} --from 0.3 --range 75 -o {stem}.png"]),
    "examples/ruler": (
        "History",
        "Acceleration of the free end and contact force: bursts that stop growing where the contact lifts off"
        " and the force falls to 0.",
        ["stridor plot {file} --kind history --channel ruler.free_end.y.acceleration --channel contact.force"
         " -o {stem}.png"]),
    "examples/stick_slip": (
        "History",
        "The tip stays where it sticks and slips on in jumps, at up to 0.1 m/s.",
        ["stridor plot {file} --kind history --channel reed.tip.x.displacement --channel contact.slip_velocity"
         " -o {stem}.png"]),
    "examples/landing": (
        "History",
        "Gap and contact force: the tip falls, bounces, and stays down under a force that swings about 2 N.",
        ["stridor plot {file} --kind history --channel contact.gap --channel contact.force --to 10ms -o {stem}.png"]),
    "beam_on_beam_leading": (
        "Spectrogram",
        "Bursts (dashed, numbered) beside the windows in which `locus` predicts growth (dotted).",
        ["stridor locus {path} --about deformed --parameter drive.displacement --from 0 --to 64.5mm --below 15kHz"
         " -o {stem}_locus.h5",
         "stridor spectrogram {file} --predict {stem}_locus.h5 --from 1.3 --max-frequency 12kHz -o {stem}.png"]),
    "beam_on_beam_limit_cycle": (
        "History",
        "Growth up to 2.06 s, where the sliding velocity reaches 0, then stick, slip and lift-off (force 0).",
        ["stridor plot {file} --kind history --channel cantilever.free_end.y.acceleration"
         " --channel contact.slip_velocity --channel contact.force --from 2 -o {stem}.png"]),
    "examples/frozen_growth": (
        "History",
        "Acceleration of the free end: a single mode grows exponentially.",
        ["stridor plot {file} --kind history --channel cantilever.free_end.y.acceleration -o {stem}.png"]),
    "examples/rough_surface": (
        "Spectrogram",
        "The burst at 3.53 kHz above the modes that the roughness excites.",
        ["stridor spectrogram {file} --max-frequency 8kHz -o {stem}.png"]),
    "examples/clamped_bridge": (
        "History",
        "Contact force after the ramp: it rings about 2 N by less than a per mille and fades.",
        ["stridor plot {file} --kind history --channel contact.force --from 0.02 -o {stem}.png"]),
    "examples/continued": (
        "History",
        "Contact force and position of the contact: 2 N and near 44 mm from the first step on.",
        ["stridor plot {file} --kind history --channel contact.force --channel contact.position -o {stem}.png"]),
    "examples/pinned_with_tables": (
        "History",
        "The contact force follows the load from 1 N to 0.5 N, the sliding velocity the drive from 0.2 m/s to"
        " 0.05 m/s.",
        ["stridor plot {file} --kind history --channel contact.force --channel contact.slip_velocity -o {stem}.png"]),
    "examples/two_pairs": (
        "History",
        "Both contact forces after the ramp, near 0.2 N.",
        ["stridor plot {file} --kind history --channel front.force --channel rear.force --from 0.1 -o {stem}.png"]),
    "examples/two_feet": (
        "History",
        "Forces of both corners: 11.75 N and 18.25 N in the end.",
        ["stridor plot {file} --kind history --channel 'contact[0].force' --channel 'contact[1].force' -o {stem}.png"]),
    "examples/slave_edge": (
        "History",
        "Forces at the leading and the trailing edge, and the gap of the latter, which opens at 1.2 ms.",
        ["stridor plot {file} --kind history --channel 'contact[0].force' --channel 'contact[2].force'"
         " --channel 'contact[2].gap' -o {stem}.png"]),
    "examples/thrown_bar": (
        "History",
        "Velocities of both ends and the force of the middle node: the wave turns the far end round at 20 µs and"
        " is back at 39 µs, when the force ends.",
        ["stridor plot {file} --kind history --channel bar.start.y.velocity --channel bar.end.y.velocity"
         " --channel 'contact[1].force' --from 1us -o {stem}.png"]),
    "examples/opposite_drives": (
        "History",
        "The sliding velocity settles at 0.5 m/s; the work of the drives goes into friction.",
        ["stridor plot {file} --kind history --channel contact.slip_velocity --channel drive_work"
         " --channel friction_loss --to 2 -o {stem}.png"]),
    "examples/stick_slip_cycle": (
        "Limit cycle",
        "One period of the tip: its place, its sliding velocity, 0 where it sticks, and the contact force.",
        []),
    "examples/flutter": (
        "Root locus",
        "Growth rates and frequencies over the load: both frequencies meet at 0.2, beyond which one motion grows.",
        ["stridor locus {path} --parameter parameters.load --from 0 --to 0.4 --points 401 --history {stem}.png"]),
    "examples/flutter_equal_damping": (
        "Root locus",
        "As without damping, moved down by it: the growth rate passes 0 at 0.228.",
        ["stridor locus {path} --parameter parameters.load --from 0 --to 0.4 --points 401 --history {stem}.png"]),
    "examples/flutter_ziegler": (
        "Root locus",
        "The frequencies no longer meet, and one motion grows from 0.173 on.",
        ["stridor locus {path} --parameter parameters.load --from 0 --to 0.4 --points 401 --history {stem}.png"]),
    "examples/flutter_gyroscopic": (
        "Root locus",
        "Gyroscopic forces keep the frequencies apart, and one motion grows at any load.",
        ["stridor locus {path} --parameter parameters.load --from 0 --to 0.4 --points 401 --history {stem}.png"]),
    "examples/gyroscopic": (
        "Root locus",
        "Growth rates fall with the load in proportion to the damping; both frequencies hardly change.",
        ["stridor locus {path} --parameter parameters.load --from 0 --to 1 --points 401 --history {stem}_load.png"]),
    "examples/rotating_support": (
        "History",
        "Accelerations of the tip and of the middle mass grow until the tip begins to stick at 0.82 s.",
        ["stridor plot {file} --kind history --channel oblique.tip.x.acceleration"
         " --channel support.middle.y.acceleration --from 0.1 -o {stem}.png"]),
    "disc_and_pads": (
        "Stability map",
        "Largest growth rate over the friction coefficient and the spin: unstable beyond 0.36 at almost any spin.",
        ["stridor map {path} --x parameters.mu 0 0.6 49 --y substructures.disc.spin 1 50 33 --figure {stem}.png"]),
    "examples/disc_squeal": (
        "History",
        "The upper pad: its velocity grows, then its contact force falls to 0 between blows.",
        ["stridor plot {file} --kind history --channel upper.block.y.velocity --channel upper.force --to 0.03"
         " -o {stem}.png"]),
    "examples/elastic_pads": (
        "Root locus",
        "Growth rates and frequencies over the friction coefficient: unstable beyond 0.263, strongly from 0.33 on,"
        " where two frequencies near 3.1 kHz meet.",
        ["stridor locus {path} --parameter parameters.mu --from 0 --to 0.6 --points 61 --below 3.6kHz"
         " --history {stem}.png"]),
    "examples/meshed_disc": (
        "Mode shape",
        "The mode that grows fastest, at 3121 Hz, a quarter of a period apart.",
        ["stridor eig {path} --count 12 --shapes {stem}_mode"]),
    "examples/brake/brake": (
        "Mode shape",
        "The mode that grows, at 6329 Hz, a quarter of a period apart: nine nodal diameters of the disc.",
        ["stridor eig {path} --below 9kHz --shapes {stem}_mode"]),
    "viscoelastic_contact": (
        "Pressure",
        "Pressure at a speed of 0.1: the contact is cut off behind, and the pressure is highest in front.",
        ["stridor contact {path} --speed 0.1 --indentation 0.01 --pressure {stem}.png"]),
    "viscoelastic_sphere": (
        "Stability map",
        "Largest growth rate over the speed and the shear strength: steady sliding is unstable in the red.",
        ["stridor map {path} --x parameters.v 1e-6 1e2 161 --y parameters.tau0 1e-4 0.1 121 --scale log"
         " --figure {stem}.png"]),
    "examples/sphere_on_rubber": (
        "Limit cycle",
        "Velocity against displacement: the sphere sticks to the substrate of 5 mm/s, then slips back.",
        ["stridor run {path} -o {stem}.h5",
         "stridor plot {stem}.h5 --kind phase --channel sphere.center.x.displacement --from 10 -o {stem}.png"]),
    "examples/beam_on_substrate": (
        "History",
        "The tip climbs in steps, one for each stick and slip, and the contact force swings with it.",
        ["stridor plot {file} --kind history --channel reed.tip.x.displacement --channel contact.force --from 0.2"
         " -o {stem}.png"]),
    "examples/bracket": (
        "Mode shape",
        "The mode at 3414 Hz, in which bracket and cantilever bend together.",
        ["stridor eig {path} --count 12 --mode 7 --shapes {stem}_mode"]),
    "examples/sliding_block": (
        "History",
        "Forces of the middle nodes of the trailing and the leading edge, which rise and fall with every facet.",
        ["stridor plot {file} --kind history --channel 'contact[5].force' --channel 'contact[9].force' -o {stem}.png"]),
    "examples/tuning_fork": (
        "History",
        "The bowed tine goes along with the bow, at 0.1 m/s, once in every period.",
        ["stridor run {path} -o {stem}.h5",
         "stridor plot {stem}.h5 --kind history --channel fork.bowed.x.velocity --channel contact.friction_force"
         " --from 0.28 -o {stem}.png"]),
    "examples/reed": (
        "History",
        "The contact force rises to 1.072 N; friction draws the tip along.",
        ["stridor plot {file} --kind history --channel contact.force --channel reed.tip.x.displacement -o {stem}.png"]),
    "examples/from_calculix": (
        "History",
        "The contact force rises with the load to 4.778 N, the friction force to three tenths of that.",
        ["stridor plot {file} --kind history --channel contact.force --channel contact.friction_force --to 0.05"
         " -o {stem}.png"]),
    "examples/from_abaqus": (
        "Mode shape",
        "The lowest mode, 10.9 kHz: the clip bends sideways.",
        ["stridor eig {path} --mode 1 --shapes {stem}_mode"]),
    "examples/from_ansys": (
        "Frequency response",
        "The toe sideways and along the plate, for a force sideways: a resonance at 10.9 kHz, two near 37 kHz.",
        ["stridor frf {path} --input clip.toe.z --output clip.toe.z.displacement"
         " --output clip.toe.x.displacement --from 1kHz --to 40kHz --points 40001 --figure {stem}.png"]),
    "examples/from_nastran": (
        "Sweep",
        "Largest and smallest contact force over the friction coefficient: steady sliding, of which friction takes"
        " load, up to 0.337; beyond it the tip sticks, slips and lifts off.",
        ["stridor sweep {path} --parameter contact.friction.coefficient --from 0 --to 0.6 --points 31"
         " --figure {stem}.png"]),
}



def first_root(found):
    return found["roots"][0]["value"]


# What a card quotes where its scene has no `expect:` block: what it is, the command, which number of its JSON, value and
# tolerance, and what it was compared with.
THRESHOLD_OF_LOAD = "stridor threshold {path} --parameter parameters.load --from 0 --to 0.4"
REFERENCES = {
    "examples/two_springs_on_a_belt": (
        "the µ from which it flutters", "stridor threshold {path} --parameter parameters.mu --from 0 --to 1.2",
        first_root, 0.75, 1e-9, "where 1 − 4µ/3 passes 0"),
    "examples/flutter": (
        "the load from which it flutters", THRESHOLD_OF_LOAD,
        first_root, 0.2, 1e-9, "half the difference of both stiffnesses"),
    "examples/flutter_equal_damping": (
        "the load from which it flutters", THRESHOLD_OF_LOAD, first_root, 0.2280350850, 1e-9, "√0.052"),
    "examples/flutter_ziegler": (
        "the load from which it flutters", THRESHOLD_OF_LOAD,
        first_root, 0.1732146068, 1e-9, "by Routh's criterion"),
    "examples/flutter_gyroscopic": (
        "the growth rate at a load of 0.05, 1/s", "stridor eig {path}",
        lambda found: max(found["eigenvalues"])[0], 0.01116627, 1e-8, "root of s⁴ + 2.41 s² + 0.01 s + 1.4025"),
    "examples/gyroscopic": (
        "the slowest decay at a load of 1, 1/s", "stridor eig {path} --set parameters.load=1",
        lambda found: max(found["eigenvalues"])[0], -0.15743415, 1e-8,
        "root of (s² + 0.4 s + 1)(s² + 0.4 s + 1.4) + 0.25 s²"),
    "disc_and_pads": (
        "the µ from which friction alone makes it grow",
        "stridor threshold {path} --set 'terms=[friction]' --parameter parameters.mu --from 0.25 --to 0.45",
        first_root, 0.3596654111, 1e-9, "[discs and pads](disc_and_pads.md)"),
    "examples/brake/brake": (
        "the frequency of the pair that squeals, Hz", "stridor eig {path} --below 9kHz",
        lambda found: max(found["eigenvalues"])[1] / 2 / math.pi, 6322.3, 19,
        "[another program's](meshes.md)"),
}
SLOW_REFERENCES = ["examples/brake/brake"]


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
        self.expected = expected(text)

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
    def shown(self):
        """Commands after that one; the last of all makes the picture of the result."""
        written = re.search(r" -o (\S+\.h5)", self.command)
        return [one.format(path=self.path, stem=self.stem, file=written and written[1])
                for one in RESULTS[self.name][2]]

    @property
    def references(self):
        """Values that the result is held to, as texts."""
        listed = [f"`{result}` {value} ± {tolerance}" for result, value, tolerance in self.expected]
        if self.name in REFERENCES:
            what, command, _, value, tolerance, source = REFERENCES[self.name]
            own = command.format(path=self.path)
            told = "" if own in [self.command, *self.shown] else f" (`{own}`)"
            listed.append(f"{what} {value} ± {tolerance:g}{told}, {source}")
        return listed

    @property
    def sentence(self):
        """The first sentence of the description."""
        return re.split(r"(?<=[a-z0-9)\]])\. (?=[A-Z])", self.description)[0].rstrip(".") + "."


class ExtremeCard:
    """An extreme scene, whose head says what it stresses, how it ends, and with which setting it copes."""

    def __init__(self, path):
        self.stem = path.stem
        self.path = f"scenes/extreme/{self.stem}.yaml"
        self.name = f"extreme/{self.stem}"
        text = path.read_text(encoding="utf-8")
        head = dict(re.findall(r"^# (Stresses|Outcome|Copes): (.*)$", text, re.M))
        self.stresses, self.outcome, copes = head["Stresses"], head["Outcome"], head.get("Copes", "")
        self.settings = "".join(f" --set {one}" for one in copes.split())
        self.references = [f"`{result}` {value} ± {tolerance}" for result, value, tolerance in expected(text)]

    def command_with(self, settings):
        return f"stridor run {self.path} -o {self.stem}.h5{settings}"

    @property
    def command(self):
        return self.command_with("")


def expected(text):
    """Result, value and tolerance of each line of an `expect:` block."""
    return re.findall(r"^  - \{result: \"?([^,\"]+)\"?, value: ([^,]+), tolerance: ([^}]+)\}", text, re.M)


def extreme_cards():
    return [ExtremeCard(path) for path in sorted((SOURCE / "scenes/extreme").glob("*.yaml"))]


def cards():
    listed = [name for names in GROUPS.values() for name in names]
    found = [str(path.relative_to(SOURCE / "scenes"))[:-5]
             for pattern in ("*.yaml", "examples/*.yaml", "examples/brake/brake.yaml")
             for path in (SOURCE / "scenes").glob(pattern)]
    if sorted(listed) != sorted(found):
        sys.exit(f"GROUPS and scenes differ: {sorted(set(listed) ^ set(found))}")
    if sorted(listed) != sorted(RESULTS):
        sys.exit(f"GROUPS and RESULTS differ: {sorted(set(listed) ^ set(RESULTS))}")
    all_cards = {name: Card(name) for name in listed}
    without = [name for name, card in all_cards.items() if not card.references]
    if without:
        sys.exit(f"these scenes have neither `expect:` nor REFERENCES: {without}")
    return all_cards


def check(all_cards, stridor):
    """Compares REFERENCES with what the program finds."""
    wrong = []
    for name in sorted(set(REFERENCES) - set(SLOW_REFERENCES)):
        what, command, number_of, value, tolerance, _ = REFERENCES[name]
        words = shlex.split(command.format(path=all_cards[name].path))
        answer = subprocess.run([stridor, *words[1:], "--json"], cwd=SOURCE, check=False, capture_output=True, text=True)
        if answer.returncode != 0:
            sys.exit(f"{name}: {answer.stderr}")
        found = number_of(json.loads(answer.stdout))
        if not abs(found - value) <= tolerance:
            wrong.append(f"{name}: {what} is {found}, not {value} ± {tolerance}")
    if wrong:
        sys.exit("\n".join(wrong))


def seconds_of(command, stridor, folder, codes=(0,)):
    """Processor time of a command in a folder that has the scenes beside it, which ends with one of `codes`."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = shlex.split(command)
    ended = subprocess.run([stridor, *words[1:]], cwd=folder, check=False, capture_output=True, text=True)
    if ended.returncode not in codes:
        sys.exit(f"{command}: {ended.returncode}: {ended.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def keep(large, small, numbers_of_colours=(64, 48, 32, 24, 16)):
    """A small picture of a large one, in the first number of colours that keeps it small."""
    from PIL import Image

    picture = Image.open(large).convert("RGB")
    size = (3 * picture.width // 10, 3 * picture.height // 10)
    picture = picture.resize(size, Image.Resampling.LANCZOS)
    for num_colours in numbers_of_colours:
        # Colours of small areas count as much as others.
        picture.quantize(num_colours, Image.Quantize.MAXCOVERAGE).save(small, optimize=True)
        if small.stat().st_size <= LARGEST:
            break


def draw_scene(card, stridor, folder):
    """A small picture of the scene, where there is something to draw."""
    large = folder / "large.png"
    drawn = subprocess.run([stridor, "draw", card.path, "-o", large, "--force"], cwd=folder,
                           capture_output=True)
    if drawn.returncode == 0:
        keep(large, PICTURES / f"{card.stem}.png", (32,))


def draw_result(card, stridor, folder):
    """A small picture of the result, after the command of the card."""
    for command in card.shown:
        seconds_of(command, stridor, folder)
    option, name = re.search(r" (-o|--\w+) (\S+)$", [card.command, *card.shown][-1]).groups()
    large = next((folder / name).glob("*.png")) if option == "--shapes" else folder / name
    keep(large, PICTURES / f"{card.stem}_result.png")


def draw_extreme(card, stridor, folder):
    """A small picture of an extreme run, of one that is refused or ends at once that with which it copes; its
    processor time."""
    seconds = seconds_of(card.command, stridor, folder, codes=(0, 2, 3))
    large = folder / f"{card.stem}.png"
    channels = [f"--channel {name}.force --channel {name}.slip_velocity" for name in ["contact", "contact[0]"]]
    for settings in ["", card.settings]:
        if settings:
            seconds_of(card.command_with(f" --force{settings}"), stridor, folder)
        for some in [*channels, "--channel upper.force"]:
            seconds_of(f"stridor plot {card.stem}.h5 --kind history {some} -o {large.name}", stridor, folder, codes=(0, 2, 4))
            if large.exists():
                keep(large, PICTURES / f"{card.stem}_result.png", (16,))
                return seconds
    return seconds


def run_all(all_cards, stridor, are_times_kept):
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
            draw_scene(card, stridor, folder)
            draw_result(card, stridor, folder)
        for card in extreme_cards():
            times[card.name] = round(draw_extreme(card, stridor, folder), 2)
    if are_times_kept:
        TIMES.write_text(json.dumps(times, indent=1) + "\n", encoding="utf-8")


def shown(seconds):
    return f"{seconds:.1f} s" if seconds >= 0.1 else "below 0.1 s"


def gallery(all_cards, times):
    lines = ["# Gallery", "",
             "The scenes of the tree, with what each shows, the command to begin with and, below it, those that make",
             "the picture of the result, all run from the folder that holds `scenes`; left out are the parts of the brake one by one.",
             "The last part are scenes at the edge of what is possible. Times are processor times of",
             "the first command, measured by `docs/make_gallery.py --measure`, which writes this page. Reference",
             "values are those of the scene's `expect:` block, which `--verify` and the tests compare, else of the command that is named.", ""]
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
            kind, seen, _ = RESULTS[name]
            lines += ["```sh", *card.needed, card.command, *card.shown, "```", "",
                      f"![{kind} of {card.stem}](figures/gallery/{card.stem}_result.png)", "",
                      f"*{kind}.* {seen}", "",
                      f"[`{card.path}`](../{card.path}), {shown(times[name])}"]
            if card.references:
                lines[-1] += f". Reference: {'; '.join(card.references)}"
            lines[-1] += "."
            lines.append("")
    return "\n".join(lines + extreme(times))


def extreme(times):
    """The cards of the extreme scenes, shorter ones."""
    lines = [f"## {EXTREME}", "",
             "Each differs from `plain` by what it stresses, and a test holds it to its end; [the table](stability.md) has forces,",
             "energy balance and times side by side. Pictures: `stridor plot FILE.h5 --kind history --channel contact.force --channel contact.slip_velocity -o FIGURE.png`.", ""]
    for card in extreme_cards():
        lines += [f"### {card.stem}", "", f"Stresses {card.stresses}.", "", "```sh", card.command]
        if card.settings:
            lines.append(card.command_with(f" --force{card.settings}") + "  # copes")
        lines += ["```", ""]
        if (PICTURES / f"{card.stem}_result.png").exists():
            lines += [f"![History of {card.stem}](figures/gallery/{card.stem}_result.png)", ""]
        end = "Runs to its end" if card.outcome == "done" else "It " + card.outcome.replace("refused", "is refused")
        lines += [f"*{end}.* [`{card.path}`](../{card.path}), {shown(times[card.name])}"
                  + (f". Reference: {'; '.join(card.references)}" if card.references else "") + ".", ""]
    return lines


def index(all_cards, times):
    lines = ["# Scenes", "",
             "A scene for every feature, in the order of [the gallery](../../docs/gallery.md), which has pictures and",
             "reference values. Commands are run from the folder that holds `scenes`. Written by `docs/make_gallery.py`.", ""]
    for group, names in GROUPS.items():
        lines += [f"## {group}", "", "| scene | what it is | command | processor time |", "|---|---|---|---|"]
        for name in names:
            card = all_cards[name]
            link = f"{name.removeprefix('examples/')}.yaml" if "/" in name else f"../{card.stem}.yaml"
            sentence = card.sentence.replace("|", "\\|")
            lines.append(f"| [`{card.stem}`]({link}) | {sentence} | `{card.command}` | {shown(times[name])} |")
        lines.append("")
    return "\n".join(lines)


def main():
    arguments = sys.argv[1:]
    all_cards = cards()
    if arguments and arguments[0] in ("--measure", "--pictures", "--check"):
        option = arguments.pop(0)
        stridor = pathlib.Path(arguments[0] if arguments else SOURCE / "build/release/stridor")
        if option == "--check":
            check(all_cards, stridor.resolve())
            return
        run_all(all_cards, stridor.resolve(), option == "--measure")
    times = json.loads(TIMES.read_text(encoding="utf-8"))
    (HERE / "gallery.md").write_text(gallery(all_cards, times), encoding="utf-8")
    (SOURCE / "scenes/examples/README.md").write_text(index(all_cards, times), encoding="utf-8")


if __name__ == "__main__":
    main()
