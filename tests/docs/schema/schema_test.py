#!/usr/bin/python3
"""Are docs/schema/*.json what the program reads and writes?

    schema_test.py PROGRAM ROOT [--without FILE:PATH | --beside FILE:PATH]

- Each map of a capture and of a recipe with every key gets a key that nothing knows. The program then lists the keys that it
  knows there: these are to be those of the schema, no more and no fewer. So with the laws' numbers.
- The keys of run.json are held against what the sources write, and against a run.
- Sample scenes, blocks of yaml in the docs, and a capture that the program makes validate.
--without forgets a key of a schema, --beside plants one: the test is to fail then. Where python3-jsonschema or
python3-yaml is missing it says NOT RUN.
"""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import jsonschema
    import yaml  # noqa: F401
except ImportError as missing:
    print(f"NOT RUN: Python's {missing.name} is missing (apt-get install python3-jsonschema python3-yaml)")
    sys.exit(0)

sys.path.insert(0, str(Path(__file__).parent))
import captures  # noqa: E402
import keys  # noqa: E402
import yaml12  # noqa: E402

PLANTED = "qqqqqqqq"


class Test:
    def __init__(self, program, root, folder):
        self.program, self.root, self.folder = program, Path(root), folder
        self.schemas = {name: json.loads((self.root / "docs/schema" / f"{name}.json").read_text())
                        for name in ("capture", "recipe", "run")}
        self.faults, self.asked = [], set()

    def fault(self, text):
        self.faults.append(text)
        print(text)

    def says(self, *words):
        done = subprocess.run([self.program, "--threads", "1", *map(str, words)], capture_output=True, text=True)
        return done.stderr + done.stdout

    # What the program says of a document.
    def says_of(self, name, document):
        file = self.folder / f"{name}.yaml"
        file.write_text(json.dumps(document))
        return self.says(*(("check", file) if name == "capture" else ("synth", file, "-o", self.folder / "never")))

    def hold_keys(self, name, document):
        schema = self.schemas[name]
        self.hold_valid(name, document, f"the {name} with every key")
        for path, place, schemas in list(keys.maps_of(document, schema, schema)):
            names_keys = {id(one) for one in schemas if keys.closed(one)}
            if not names_keys or names_keys <= self.asked:
                continue
            place[PLANTED] = 1
            said = self.says_of(name, document)
            del place[PLANTED]
            where = f"{name}.json at {'/'.join(map(str, path)) or 'the top'}"
            law = f"has no parameter `{PLANTED}`" in said
            listed = re.search(rf"has no key `{PLANTED}`\n\s*known here: (.*)", said)
            if law:
                continue  # hold_laws() asks
            if listed:
                reads = set(listed.group(1).split(", "))
                if "measured" in path and "field" not in place:
                    reads.discard("field")  # it is read by itself, as another map
            else:
                self.fault(f"{where}: the program does not list its keys, it says\n{said}")
                continue
            self.compare(where, keys.known_keys(schemas), reads)
            self.asked.update(id(one) for one in schemas)

    def compare(self, where, knows, reads):
        for key in sorted(reads - knows):
            self.fault(f"{where}: `{key}` is not in the schema, and the program reads it")
        for key in sorted(knows - reads):
            self.fault(f"{where}: `{key}` is in the schema, and the program does not read it")

    def hold_laws(self):
        capture = captures.plain_capture()
        schema = self.schemas["capture"]
        for law in schema["definitions"]["material"]["properties"]["law"]["enum"]:
            if law == "additive":
                continue
            capture["model"] = {"material": {"law": law, PLANTED: 1}}
            said = self.says_of("capture", capture)
            usage = re.search(rf"the law {law} has no parameter `{PLANTED}`\n(.*)", said)
            if not usage:
                self.fault(f"capture.json: of the law {law} the program says\n{said}")
                continue
            reads = {"law", "blend"}
            for braces in re.findall(r"\{(.*?)\}", usage.group(1)):
                reads.update(re.findall(r"[a-z_]+[0-9]*", braces))
            for wanted in re.findall(r"and if wanted ((?:\w+, )*\w+)", usage.group(1)):
                reads.update(wanted.removesuffix(" or").split(", "))
            branch = schema["definitions"][f"law_{law}"]
            self.compare(f"capture.json, law {law}", set(branch["properties"]), reads)
            self.asked.add(id(branch))

    def hold_all_asked(self, name, but=()):
        """A map of the schema that no document has would be held against nothing."""
        for one in keys.closed_maps(self.schemas[name]):
            if id(one) not in self.asked and set(one["properties"]) not in but:
                self.fault(f"{name}.json: no document of this test has the map {sorted(one['properties'])}")

    def hold_valid(self, name, document, what):
        for error in jsonschema.Draft7Validator(self.schemas[name]).iter_errors(document):
            self.fault(f"{what}: {name}.json refuses it at {'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")

    def hold_texts(self):
        """What people copy: sample scenes, and whole documents in the docs."""
        count = 0
        for file in sorted((self.root / "sample_scenes").glob("*.yaml")):
            self.hold_valid("recipe", yaml12.read(file.read_text()), f"sample_scenes/{file.name}")
            count += 1
        for page in sorted((self.root / "docs").glob("*.md")):
            for block in re.findall(r"^```\w*\n(.*?)^```", page.read_text(), re.M | re.S):
                for name, head in (("capture", "hookeye: 1"), ("recipe", "hookeye_recipe: 1")):
                    if re.match(rf"(#.*\n)*{head}", block):
                        self.hold_valid(name, yaml12.read(block), f"docs/{page.name}, the block `{head}`")
                        count += 1
        print(f"{count} scenes and blocks of the docs")

    def hold_run(self):
        """A capture of the program, its run, and what the sources write into run.json."""
        drawn, _ = captures.full_recipes()
        drawn["hidden"], drawn["photos"] = [], {}
        drawn["examples"] = {"rest": {}, "pull": {"force": [0, 0, 0.1]}, "held": {"use": "validate", "force": [0, 0, 0.05]}}
        recipe, capture, run = self.folder / "recipe.yaml", self.folder / "made", self.folder / "run"
        recipe.write_text(json.dumps(drawn))
        said = [self.says("synth", recipe, "-o", capture), self.says("fit", capture, "-o", run), self.says("diagnose", run)]
        if not (run / "run.json").exists():
            return self.fault("no run was made:\n" + "\n".join(said))
        self.hold_valid("capture", yaml12.read((capture / "capture.yaml").read_text()), "what synth made")
        made = json.loads((run / "run.json").read_text())
        self.hold_valid("run", made, "a run")
        if not made["steps"][-1]["diagnosis"]:
            self.fault("the run has no diagnosis:\n" + said[-1])
        schema = self.schemas["run"]
        text = lambda path: (self.root / path).read_text()
        inner = text("estimation/output/step_json.cpp").partition("json timeline_entry(")[2].partition("\n}\n")[0]
        entry = inner.partition("json entry = {")[2].partition("};")[0]
        step = set(re.findall(r'\{"(\w+)", (?!one|raced)', entry))
        step |= set(re.findall(r'\bentry\["(\w+)"\]', inner + text("runs/record.cpp") + text("capture_io/run.cpp")))
        top = {"steps"} | set(re.findall(r'\{\{?"(\w+)", ', text("capture_io/run.cpp").partition("impl->store({")[2].partition("});")[0]))
        for file in ("runs/record.cpp", "runs/search.cpp", "runs/run_limits.cpp", "capture_io/run.cpp"):
            top |= set(re.findall(r'\btimeline\["(\w+)"\](?!\.)(?:\[[^]]*\])? =', text(file)))
        self.compare("run.json of a step", set(schema["definitions"]["step"]["properties"]), step)
        self.compare("run.json at the top", set(schema["properties"]), top)
        scored = text("estimation/diagnosis/diagnosis_json.cpp")
        effect = set(re.findall(r'\bout\["(\w+)"\]', scored.partition("json effect_json(")[2].partition("\n}\n")[0]))
        effect |= set(re.findall(r'effects\.back\(\)\["(\w+)"\]', scored)) | {"effect", "testable"}
        self.compare("run.json of an effect", set(schema["definitions"]["effect"]["properties"]), effect)

    def hold_refusals(self):
        """A schema that takes everything would pass all of the above."""
        for path, value in ((("body", "mesh", "edge"), -1), (("model", "material"), {"law": "neo-hookean", "mu": 1}),
                            (("cameras", "front", "projection"), "pinhole"), (("examples", "pull", "use"), "train"),
                            (("regions", "base"), {}), (("light",), {"sun": 1}),
                            (("cameras", "front", "vignetting"), -1), (("cameras", "front", "chromatic_shift"), {"green": 1}),
                            (("light", "harmonics"), "fit"), (("light",), {"harmonics": [1, 2]}),
                            (("examples",), {"from": "cases.txt"})):
            document = captures.full_capture()
            place = document
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = value
            if jsonschema.Draft7Validator(self.schemas["capture"]).is_valid(document):
                self.fault(f"capture.json takes {'/'.join(path)}: {value}")
        for harmonics in ("fit", [1] + 8 * [0]):
            document = {**captures.full_capture(), "light": {"harmonics": harmonics}}
            if not jsonschema.Draft7Validator(self.schemas["capture"]).is_valid(document):
                self.fault(f"capture.json refuses light of harmonics: {harmonics}")
        for lens in ({"vignetting": "fit"}, {"vignetting": 1.2, "chromatic_shift": {"red": 1.0003}}, {"chromatic_shift": "fit"}):
            document = captures.full_capture()
            document["cameras"]["front"].update(lens)
            if not jsonschema.Draft7Validator(self.schemas["capture"]).is_valid(document):
                self.fault(f"capture.json refuses a lens: {lens}")
        for section in ("cameras", "examples"):
            document = {**captures.full_capture(), section: {"from": "parts/of_it.yaml"}}
            if not jsonschema.Draft7Validator(self.schemas["capture"]).is_valid(document):
                self.fault(f"capture.json refuses a file of {section}")


def plant(test, how, where):
    name, path = where.split(":")
    *parents, last = path.split("/")
    node = test.schemas[name.removesuffix(".json")]
    for part in parents:
        node = node[int(part) if isinstance(node, list) else part]
    if how == "--without":
        del node[last]
    else:
        node[last] = {}


def main(program, root, *planted):
    with tempfile.TemporaryDirectory() as folder:
        test = Test(program, root, Path(folder))
        only = None
        if planted:
            plant(test, *planted)
            only = planted[1].partition(".")[0]
        captures.write_files(test.folder)
        if only in (None, "capture"):
            for capture in (captures.plain_capture(), captures.full_capture()):
                test.hold_keys("capture", capture)
            test.hold_laws()
            test.hold_all_asked("capture", but=({"from"}, {"axis", "center"}))  # of files, of a law's frame
        if only in (None, "recipe"):
            for recipe in captures.full_recipes():
                test.hold_keys("recipe", recipe)
            test.hold_all_asked("recipe")
        if only in (None, "run"):
            test.hold_run()
        if not only:
            test.hold_texts()
            test.hold_refusals()
    print(f"{len(test.asked)} maps asked of the program, {len(test.faults)} faults")
    return 1 if test.faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
