"""The Python reference: signatures and docstrings of the package, and of its module's stub where the module was built."""

import ast
import re
import textwrap
from pathlib import Path


def read_module(path):
    """Top-level classes and functions by name, and names imported from modules of the package: name -> (module, name)."""
    defined, imported = {}, {}
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            defined.setdefault(node.name, []).append(node)
        elif isinstance(node, ast.ImportFrom) and node.level == 1:
            for alias in node.names:
                imported[alias.asname or alias.name] = (node.module, alias.name)
    return defined, imported


def exported(tree):
    """Names that a module exports, in alphabetical order."""
    names = next(ast.literal_eval(node.value) for node in tree.body
                 if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__")
    return sorted((name for name in names if not name.startswith("__")), key=str.lower)


class Package:
    def __init__(self, folder, stub):
        self.folder = folder
        self.modules = {"__init__": read_module(folder / "__init__.py")}
        self.stub = stub if stub and stub.exists() else None

    def module(self, name):
        if name not in self.modules:
            path = self.stub if name == "_vesalius" else self.folder / f"{name}.py"
            self.modules[name] = read_module(path) if path and path.exists() else ({}, {})
        return self.modules[name]

    def find(self, name, module="__init__"):
        """Nodes that define a name, with the module they stand in; none where the module was not built."""
        defined, imported = self.module(module)
        if name in defined:
            return defined[name], module
        if name in imported:
            return self.find(imported[name][1], imported[name][0])
        return [], module

    def members(self, nodes, module):
        """A class's public members by name, those of its bases before its own."""
        found = {}
        for node in nodes:
            for base in node.bases:
                if isinstance(base, ast.Name):
                    found |= self.members(*self.find(base.id, module))
            own = {}
            for member in node.body:
                if isinstance(member, ast.FunctionDef) and is_public(member):
                    own.setdefault(member.name, []).append(member)
                elif isinstance(member, ast.AnnAssign) and not member.target.id.startswith("_"):
                    own[member.target.id] = [member]
            found |= own
        return found


def is_public(member):
    setter = any(getattr(each, "attr", "") == "setter" for each in member.decorator_list)
    return not setter and (member.name == "__init__" or not member.name.startswith("_"))


def docstring_of(node):
    """A docstring; of one that the class puts together, what stands in it as text."""
    for each in getattr(node, "body", []):
        if isinstance(each, ast.Assign) and getattr(each.targets[0], "id", "") == "__doc__" and isinstance(each.value, ast.JoinedStr):
            pieces = [piece.value if isinstance(piece, ast.Constant) else f"``vesalius.{ast.unparse(piece.value)}`` says." for piece in each.value.values]
            return re.sub(r"(?m)^    ", "", "".join(pieces))
    return ast.get_docstring(node)


def escaped(text):
    """Plain text as reStructuredText; `code` and ``code`` are code."""
    pieces = re.split(r"(`+[^`]+`+)", text)
    return "".join(f"``{piece.strip('`')}``" if piece.startswith("`") else re.sub(r"([\\*|`_])", r"\\\1", piece) for piece in pieces)


def described(docstring):
    """A docstring's paragraphs; indented ones are programs."""
    paragraphs = []
    for paragraph in re.split(r"\n\s*\n", docstring or ""):
        if paragraph.startswith("    "):
            paragraphs.append(".. code-block:: python\n\n" + textwrap.indent(textwrap.dedent(paragraph), "   "))
        elif paragraph.strip():
            paragraphs.append(escaped(paragraph.strip()))
    return "\n\n".join(paragraphs)


def signature(function, in_class):
    arguments = ast.parse(f"def f({ast.unparse(function.args)}): ...").body[0].args
    first = arguments.posonlyargs or arguments.args
    if in_class and first and not any(getattr(each, "id", "") == "staticmethod" for each in function.decorator_list):
        first.pop(0)
    result = f" -> {ast.unparse(function.returns)}" if function.returns and function.name != "__init__" else ""
    # Arrays are described in words; what the module checks of them besides is no help here.
    return re.sub(r"Annotated\[(\w+), dict\([^)]*\)\]", r"\1", f"({ast.unparse(arguments)}){result}")


def directive(kind, line, text, indent=0):
    block = f".. py:{kind}:: {line}\n\n" + textwrap.indent(text, "   ")
    return textwrap.indent(block.rstrip(), "   " * indent) + "\n\n"


def is_property(nodes):
    return isinstance(nodes[0], ast.AnnAssign) or any(getattr(each, "id", "") == "property" for each in nodes[0].decorator_list)


def member_page(name, nodes):
    if is_property(nodes):
        node = nodes[0]
        kind = node.annotation if isinstance(node, ast.AnnAssign) else node.returns
        text = "" if isinstance(node, ast.AnnAssign) else described(ast.get_docstring(node))
        return directive("attribute", name + (f"\n   :type: {ast.unparse(kind)}" if kind else ""), text, 1)
    lines = "\n              ".join(name + signature(node, True) for node in nodes)
    return directive("method", lines, described(next(filter(None, map(ast.get_docstring, nodes)), "")), 1)


def class_page(package, name, nodes, module):
    members = package.members(nodes, module)
    starts = members.pop("__init__", [])
    line = name + (signature(starts[-1], True) if starts else "")
    text = "\n\n".join(described(docstring_of(each)) for each in [*nodes, *starts])
    return directive("class", line, text) + "".join(member_page(each, found) for each, found in members.items())


def members_page(package, name, module="__init__"):
    nodes, module = package.find(name, module)
    if not nodes:
        return directive("data", name, "Of the compiled module, which was not built with these pages.")
    if isinstance(nodes[0], ast.ClassDef):
        return class_page(package, name, nodes, module)
    lines = "\n                ".join(name + signature(node, False) for node in nodes)
    return directive("function", lines, described(next(filter(None, map(ast.get_docstring, nodes)), "")))


def module_page(package, name, module):
    """What a module exports, below its docstring."""
    tree = ast.parse((package.folder / f"{module}.py").read_text())
    return (described(ast.get_docstring(tree, clean=False)) + f"\n\n.. py:module:: {name}\n\n" +
            "".join(members_page(package, each, module) for each in exported(tree)))


def write(source, staged, stub):
    """Writes reference/python.rst. Returns whether the module's stub was there to tell all."""
    package = Package(source / "python/vesalius", stub)
    out = "Python reference\n================\n\nThe package ``vesalius``; the guide :doc:`/python` says how to install and use it.\n\n"
    out += module_page(package, "vesalius", "__init__")
    for path in sorted(package.folder.glob("[a-z]*.py")):
        title = f"vesalius.{path.stem}"
        out += f"{title}\n{'-' * len(title)}\n\n" + module_page(package, title, path.stem)
    page = staged / "reference/python.rst"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(out)
    return package.stub is not None
