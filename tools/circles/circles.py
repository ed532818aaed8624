#!/usr/bin/env python3
"""Circles between the source files of each crate: files that import each other, directly or through others.

    circles.py [ROOT]

ROOT is the repository, by default the one that this file is in. Looks at every crate in crates/, apps/ and
integrations/check, from src/lib.rs and src/main.rs on through the modules that they declare. A file imports another
one if it names something that is defined there: in a `use`, or by a path that begins with `crate`, `super`, `self` or
a module that is in scope. Names are followed through re-exports to the file that defines them.

Not counted: code under `#[cfg(test)]` (but in integrations/check, which is tests alone), files of tests, comments and
strings, what macros make of their input, and whatever is between a module and the modules inside it, at any depth,
since a module declares these.

Prints each circle (a strongly connected component of more than one file) with its imports and the names that they are
for. Exits 1 if there is one.
"""

import re
import sys
from pathlib import Path

# Comments (those of blocks without nesting), strings, raw strings and characters.
NO_CODE = re.compile(
    r"""//[^\n]*|/\*.*?\*/|\bb?r(?P<hashes>\#*)".*?"(?P=hashes)|b?"(?:\\.|[^"\\])*"|b?'(?:\\.[^'\n]*|[^'\\\n])'""",
    re.DOTALL,
)
TEST_ONLY = re.compile(r"#\s*\[\s*cfg\s*\(\s*(?:test\b|all\s*\(\s*test\b)[^\]]*\]")
# A crate that has nothing but tests, so that its modules are looked at as those of any other.
TESTS_ALONE = "integrations/check"
MODULE = re.compile(r"\bmod\s+(\w+)\s*([;{])")
USE = re.compile(r"\buse\s+([^;]+);")
PATH = re.compile(r"(?<![\w:.$])((?:r#)?\w+)((?:\s*::\s*\w+)+)")
DEFINITION = r"\b(?:fn|struct|enum|union|trait|type|const|static|mod|macro_rules!)\s+(?:mut\s+)?{}\b"


def closing(text, start):
    """The index after the brace that closes the one at `start`."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        if depth == 0:
            return at + 1
    return len(text)


def end_of_item(text, start):
    """The index after an item: its semicolon, or the end of its body."""
    depth = 0
    for at in range(start, len(text)):
        if text[at] in "([":
            depth += 1
        elif text[at] in ")]":
            depth -= 1
        elif depth == 0 and text[at] == "{":
            # The braces of a `use` are followed by its semicolon.
            end = closing(text, at)
            return end + 1 if text[end : end + 1] == ";" else end
        elif depth == 0 and text[at] in ";,}":
            return at + 1 if text[at] == ";" else at
    return len(text)


def code(text):
    """A file's text without comments, strings and what only tests compile. Paths in attributes stay as they are."""
    text = NO_CODE.sub(lambda found: "" if found[0].startswith("/") else '""', text)
    while found := TEST_ONLY.search(text):
        text = text[: found.start()] + text[end_of_item(text, found.end()) :]
    return text


def leaves(tree, prefix=()):
    """The paths of a `use`, each with the name that it gets; `*` for all names and `_` for none."""
    tree = tree.strip()
    if "{" in tree:
        before, inside = tree.split("{", 1)
        prefix = prefix + tuple(part.strip() for part in before.split("::") if part.strip())
        depth, part = 0, ""
        for letter in inside[: inside.rindex("}")] + ",":
            depth += {"{": 1, "}": -1}.get(letter, 0)
            if letter == "," and depth == 0:
                if part.strip():
                    yield from leaves(part, prefix)
                part = ""
            else:
                part += letter
        return
    path, _, name = (part.strip() for part in re.sub(r"\s+as\s+", " as ", tree).partition(" as "))
    path = prefix + tuple(part.strip() for part in path.split("::") if part.strip())
    if len(path) > 1 and path[-1] == "self":
        path = path[:-1]
    yield path, name or path[-1]


class Module:
    """A module: its file, the modules inside it, and what it imports."""

    def __init__(self, name, file, parent, text):
        self.name, self.file, self.parent = name, file, parent
        self.inside, self.names, self.all_of = {}, {}, []
        # Modules in braces first, so that what is left is this module's own.
        at = 0
        while found := MODULE.search(text, at):
            if found[2] == "{":
                end = closing(text, found.end() - 1)
                self.inside[found[1]] = Module(found[1], file, self, text[found.end() : end - 1])
                text = text[: found.start()] + text[end:]
                at = found.start()
            else:
                self.declare(found[1])
                at = found.end()
        self.text = text
        for found in USE.finditer(text):
            for path, name in leaves(found[1]):
                if name == "*":
                    self.all_of.append(path[:-1])
                elif name != "_":
                    self.names[name] = path
        self.paths = [path for found in USE.finditer(text) for path, _ in leaves(found[1])]
        for found in PATH.finditer(USE.sub("", text)):
            self.paths.append((found[1], *(part.strip() for part in found[2].split("::")[1:])))

    def folder(self):
        """Where the files of modules inside this one are."""
        if self.file.stem in ("lib", "main", "mod"):
            return self.file.parent if self.parent is None or self.parent.file != self.file else (
                self.parent.folder() / self.name
            )
        return self.file.parent / self.file.stem

    def declare(self, name):
        for file in (self.folder() / f"{name}.rs", self.folder() / name / "mod.rs"):
            if file.is_file():
                self.inside[name] = Module(name, file, self, code(file.read_text()))

    def root(self):
        return self if self.parent is None else self.parent.root()

    def all(self):
        yield self
        for module in self.inside.values():
            yield from module.all()

    def above(self):
        return [] if self.parent is None else [self.parent, *self.parent.above()]

    def find(self, path, seen=frozenset()):
        """The module that a path leads to and what of it is left: the name of what is defined there, or nothing where the
        path is a module's. `None` for paths that leave the crate."""
        if (self, path) in seen:
            return None
        seen = seen | {(self, path)}
        first, rest = path[0], path[1:]
        if first == "crate":
            return self.root().walk(rest, seen)
        if first == "self":
            return self.walk(rest, seen)
        if first == "super":
            return self.parent.find(("self", *rest), seen) if self.parent else None
        return self.walk(path, seen) if first in self.inside or first in self.names else None

    def walk(self, path, seen):
        if not path:
            return self, ()
        first, rest = path[0], path[1:]
        if first == "super":
            return self.parent.walk(rest, seen) if self.parent else None
        if first in self.inside:
            return self.inside[first].walk(rest, seen)
        if first in self.names:
            return self.find((*self.names[first], *rest), seen)
        if not re.search(DEFINITION.format(re.escape(first)), self.text):
            for path_of_all in self.all_of:
                found = self.find(path_of_all, seen)
                if found and not found[1] and found[0] is not self:
                    module = found[0]
                    if first in module.inside or first in module.names or re.search(
                        DEFINITION.format(re.escape(first)), module.text
                    ):
                        return module.walk(path, seen)
        return self, path


def imports(root):
    """For each file of a crate the files that it imports, with the names that it imports from there."""
    out = {}
    for module in root.all():
        own = out.setdefault(module.file, {})
        for path in module.paths:
            is_all = path[-1] == "*"
            found = module.find(path[:-1] if is_all else path) if len(path) > 1 or not is_all else None
            if found is None:
                continue
            target, left = found
            # A module that is only brought into scope is asked for nothing yet.
            if (not left and not is_all) or target.file == module.file:
                continue
            if any(above.file == target.file for above in module.above()):
                continue
            if any(above.file == module.file for above in target.above()):
                continue
            own.setdefault(target.file, set()).add(left[0] if left else "*")
    return out


def circles(graph):
    """Strongly connected components of more than one node (Tarjan 1972)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            component = stack[at:]
            del stack[at:]
            if len(component) > 1:
                found.append(sorted(component))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def main(root):
    sys.setrecursionlimit(10_000)
    crates = sorted(
        manifest.parent
        for pattern in ("crates/*/Cargo.toml", "apps/*/Cargo.toml", f"{TESTS_ALONE}/Cargo.toml")
        for manifest in root.glob(pattern)
    )
    count = 0
    for crate in crates:
        for start in (crate / "src/lib.rs", crate / "src/main.rs"):
            if not start.is_file():
                continue
            text = start.read_text()
            if crate == root / TESTS_ALONE:
                text = TEST_ONLY.sub("", text)
            graph = imports(Module("", start, None, code(text)))
            for circle in circles(graph):
                count += 1
                print(f"{crate.relative_to(root)}: {len(circle)} files in a circle")
                for file in circle:
                    for other in sorted(set(graph[file]) & set(circle)):
                        here, there = (f.relative_to(crate / "src") for f in (file, other))
                        print(f"  {here} -> {there}: {', '.join(sorted(graph[file][other]))}")
    print(f"{len(crates)} crates, {count} circles")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2]).resolve()))
