# SPDX-License-Identifier: MIT
"""Where a source may be changed, and into what: walks Clang's syntax tree of each room.

A site is one range of one file with one or more changes of which one is taken. The text of a change refers to ranges
within it, which may hold sites themselves. Left out is what the compiler computes: constexpr, static_assert, labels,
template arguments, types; what a macro writes; and operators of classes, whose result has another type for each operator.
"""
import subprocess

import clang.cindex as cindex

from source import Change, Site, Source, short

Kind = cindex.CursorKind
Type = cindex.TypeKind

INTEGERS = {Type.INT, Type.UINT, Type.LONG, Type.ULONG, Type.LONGLONG, Type.ULONGLONG, Type.SHORT, Type.USHORT, Type.SCHAR,
            Type.UCHAR, Type.CHAR_S, Type.CHAR_U}
FLOATS = {Type.FLOAT, Type.DOUBLE}
COMPARISONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "/", "&": "|", "|": "&", "^": "|", "<<": ">>", ">>": "<<"}
ASSIGNMENTS = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "^=": "|=", "<<=": ">>=", ">>=": "<<="}
FUNCTIONS = {Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.CONVERSION_FUNCTION,
             Kind.FUNCTION_TEMPLATE}
LEAVES = {Kind.RETURN_STMT, Kind.CONTINUE_STMT, Kind.BREAK_STMT}


class Walk:
    def __init__(self, sources):
        self.sources = sources
        self.sites = {}

    # A range of a cursor in its source, or nothing where a macro wrote it.
    def range_of(self, cursor):
        extent = cursor.extent
        if extent.start.file is None or extent.end.file is None or extent.start.file.name != extent.end.file.name:
            return None
        source = self.sources.get(extent.start.file.name)
        start, end = extent.start.offset, extent.end.offset
        if source is None or end <= start or source.in_macro(start, end):
            return None
        return source, start, end

    def add(self, source, start, end, ranges, changes, line):
        key = (source.path, start, end, "wrap" if ranges == [(start, end)] else "split")
        if key in self.sites:
            return
        self.sites[key] = Site(source.path, line, start, end, ranges, changes,
                               1 + source.bytes.count(b"\n", start, end), source.line_text(start))

    def top(self, cursor):
        for child in cursor.get_children():
            file = child.location.file
            if file is None or file.name not in self.sources:
                continue
            if child.kind in FUNCTIONS:
                self.function(child)
            elif child.kind in (Kind.NAMESPACE, Kind.CLASS_DECL, Kind.STRUCT_DECL, Kind.CLASS_TEMPLATE, Kind.LINKAGE_SPEC,
                                Kind.UNEXPOSED_DECL):
                self.top(child)

    def function(self, cursor):
        body = next((child for child in cursor.get_children() if child.kind == Kind.COMPOUND_STMT), None)
        found = self.range_of(cursor)
        if body is None or found is None:
            return
        source, start, _ = found
        head = source.text(start, body.extent.start.offset)
        if "constexpr" in head.split() or "consteval" in head.split():
            return
        for child in cursor.get_children():
            if child.kind not in (Kind.PARM_DECL, Kind.TEMPLATE_REF, Kind.TYPE_REF, Kind.NAMESPACE_REF,
                                  Kind.TEMPLATE_NON_TYPE_PARAMETER, Kind.TEMPLATE_TYPE_PARAMETER):
                self.visit(child, cursor)

    def visit(self, cursor, parent):
        kind = cursor.kind
        if kind in (Kind.STATIC_ASSERT, Kind.PARM_DECL, Kind.TYPE_ALIAS_DECL):
            return
        found = self.range_of(cursor)
        if kind == Kind.VAR_DECL and found and "constexpr" in found[0].text(found[1], found[2]).split("=")[0].split():
            return
        if kind == Kind.CASE_STMT:
            for child in list(cursor.get_children())[1:]:
                self.visit(child, cursor)
            return
        if found:
            self.look(cursor, parent, *found)
        for child in cursor.get_children():
            self.visit(child, cursor)

    def look(self, cursor, parent, source, start, end):
        kind, line = cursor.kind, cursor.extent.start.line
        if kind == Kind.BINARY_OPERATOR:
            self.binary(cursor, source, start, end, line)
        elif kind == Kind.COMPOUND_ASSIGNMENT_OPERATOR:
            self.split(cursor, source, start, end, line, ASSIGNMENTS)
        elif kind == Kind.UNARY_OPERATOR:
            self.unary(cursor, source, start, end, line)
        elif kind == Kind.IF_STMT:
            self.guard(cursor, line)
        elif kind == Kind.CALL_EXPR:
            self.call(cursor, source, start, end, line)
        elif kind == Kind.ARRAY_SUBSCRIPT_EXPR:
            self.index(list(cursor.get_children())[-1])
        elif kind in (Kind.INTEGER_LITERAL, Kind.FLOATING_LITERAL, Kind.CXX_BOOL_LITERAL_EXPR):
            self.literal(cursor, parent, source, start, end, line)
        elif kind == Kind.DECL_REF_EXPR:
            self.constant(cursor, source, start, end, line)
        elif kind == Kind.COMPOUND_STMT:
            for child in cursor.get_children():
                self.dropped(child)

    def split(self, cursor, source, start, end, line, table):
        operands = list(cursor.get_children())
        if len(operands) != 2:
            return
        left, right = (self.range_of(operand) for operand in operands)
        if not left or not right:
            return
        operator = source.text(left[2], right[1]).strip().lstrip(")").rstrip("(").strip()
        changed = table.get(operator)
        if changed is None:
            return
        whole = source.text(start, end)
        changes = []
        for other in [changed] if isinstance(changed, str) else changed:
            before, between, after = (source.text(start, left[1]), source.text(left[2], right[1]), source.text(right[2], end))
            there = "{0}" + between.replace(operator, other) + "{1}"
            as_is = "{0}" + between + "{1}"
            changes.append(Change(f"{short(whole)} -> {other}", "(armsig_mutant({N}) ? (" + there + ") : (" + as_is + "))"))
            if before or after:
                return
        self.add(source, start, end, [left[1:], right[1:]], changes, line)

    def binary(self, cursor, source, start, end, line):
        operands = list(cursor.get_children())
        if len(operands) != 2:
            return
        kinds = [operand.type.get_canonical().kind for operand in operands]
        plain = all(kind in INTEGERS | FLOATS or kind == Type.BOOL for kind in kinds)
        self.split(cursor, source, start, end, line, {"&&": "||", "||": "&&"})
        if plain:
            floats = any(kind in FLOATS for kind in kinds)
            # Next to a bound there is no reading: of real numbers only the sense is turned.
            comparisons = {key: (value[-1],) if floats else value for key, value in COMPARISONS.items()}
            self.split(cursor, source, start, end, line, comparisons)
            self.split(cursor, source, start, end, line, ARITHMETIC)
        elif all(kind in (Type.ENUM, Type.BOOL, Type.POINTER) for kind in kinds):
            self.split(cursor, source, start, end, line, {"==": ("!=",), "!=": ("==",)})

    def unary(self, cursor, source, start, end, line):
        operand = next(cursor.get_children(), None)
        inner = operand and self.range_of(operand)
        if not inner or operand.kind in (Kind.INTEGER_LITERAL, Kind.FLOATING_LITERAL):
            return
        operator = source.text(start, inner[1])
        if operator == "!":
            text = "(armsig_mutant({N}) ? static_cast<bool>({0}) : !{0})"
        elif operator == "-" and operand.type.get_canonical().kind in INTEGERS | FLOATS:
            text = "(armsig_mutant({N}) ? +{0} : -{0})"
        else:
            return
        self.add(source, start, end, [inner[1:]], [Change(f"{short(source.text(start, end))} -> without {operator}", text)], line)

    def guard(self, cursor, line):
        children = list(cursor.get_children())
        if any(child.kind == Kind.VAR_DECL for child in children):
            return
        if children and children[0].kind == Kind.DECL_STMT:
            children = children[1:]
        if len(children) != 2:
            return
        condition, then = children
        whole, found = self.range_of(cursor), self.range_of(condition)
        if not whole or not found or "constexpr" in whole[0].text(whole[1], found[1]):
            return
        last = then
        if then.kind == Kind.COMPOUND_STMT:
            inside = list(then.get_children())
            last = inside[-1] if inside else then
        name = "guard dropped" if last.kind in LEAVES else "condition never true"
        source, start, end = found
        self.add(source, start, end, [(start, end)],
                 [Change(f"{short(source.text(start, end))} -> {name}", "(!armsig_mutant({N}) && ({0}))")], line)

    def call(self, cursor, source, start, end, line):
        arguments = [self.range_of(argument) for argument in cursor.get_arguments()]
        name = cursor.spelling
        if name == "operator[]":
            operands = list(cursor.get_children())
            if operands:
                self.index(operands[-1])
            return
        text = source.text(start, end)
        result = cursor.type.get_canonical().kind
        if not all(arguments) or result not in INTEGERS | FLOATS:
            return
        if name == "clamp" and len(arguments) == 3 and text.startswith("std::clamp"):
            self.add(source, start, end, [(start, end), arguments[0][1:]],
                     [Change(f"{short(text)} -> not clamped", "(armsig_mutant({N}) ? {1} : {0})")], line)
        elif name in ("min", "max") and len(arguments) == 2 and text.startswith("std::" + name):
            other = "max" if name == "min" else "min"
            callee = text[: text.index("(")]
            swapped = callee.replace("std::" + name, "std::" + other)
            self.add(source, start, end, [arguments[0][1:], arguments[1][1:]],
                     [Change(f"{short(text)} -> {other}",
                             "(armsig_mutant({N}) ? " + swapped + "({0}, {1}) : " + callee + "({0}, {1}))")], line)

    def index(self, cursor):
        found = self.range_of(cursor)
        if not found or cursor.type.get_canonical().kind not in INTEGERS:
            return
        source, start, end = found
        self.add(source, start, end, [(start, end)],
                 [Change(f"[{short(source.text(start, end))}] -> beside", "armsig_other_index({N}, {0})")], cursor.extent.start.line)

    def literal(self, cursor, parent, source, start, end, line):
        text = source.text(start, end)
        around = source.text(max(start - 1, 0), start), source.text(end, end + 1)
        if parent.kind in (Kind.DECL_REF_EXPR, Kind.MEMBER_REF_EXPR) or around[0] == "<" or around[1] == ">":
            return
        if text in ("true", "false"):
            other = "false" if text == "true" else "true"
        elif text[0] in ".0123456789" and cursor.type.get_canonical().kind in INTEGERS | FLOATS:
            digits = text.rstrip("uUlLfFzZ")
            zero = set(digits.lower().replace("x", "").replace(".", "")) <= {"0"}
            other = "1" + text[len(digits):] if zero else (f"2 * {text}" if cursor.kind == Kind.FLOATING_LITERAL else f"{text} + 1")
        else:
            return
        self.add(source, start, end, [], [Change(f"{text} -> {other}", "(armsig_mutant({N}) ? " + other + " : " + text + ")")], line)

    # A named constant at the place of its use.
    def constant(self, cursor, source, start, end, line):
        declared = cursor.referenced
        if declared is None or declared.kind != Kind.VAR_DECL or not cursor.spelling.startswith("k"):
            return
        kind = cursor.type.get_canonical().kind
        around = source.text(max(start - 1, 0), start), source.text(end, end + 1)
        if kind not in INTEGERS | FLOATS or around[0] == "<" or around[1] in (">", "[", "."):
            return
        text = source.text(start, end)
        other = f"2 * {text}" if kind in FLOATS else f"{text} + 1"
        self.add(source, start, end, [], [Change(f"{text} -> {other}", "(armsig_mutant({N}) ? " + other + " : " + text + ")")], line)

    def dropped(self, cursor):
        if cursor.kind not in (Kind.CALL_EXPR, Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR):
            return
        found = self.range_of(cursor)
        if not found:
            return
        source, start, end = found
        semicolon = source.bytes.find(b";", end)
        if source.text(end, semicolon).strip():
            return
        self.add(source, start, semicolon + 1, [(start, semicolon + 1)],
                 [Change(f"{short(source.text(start, end))} -> dropped", "if (!armsig_mutant({N})) {0}")], cursor.extent.start.line)


def command_line():
    """What clang needs beyond its defaults: the compiler's own headers, which the library alone does not know."""
    resources = subprocess.run(["clang++-19", "-print-resource-dir"], check=True, capture_output=True, text=True).stdout.strip()
    return ["-std=c++23", "-xc++", "-I.", "-isystem", "/usr/include/eigen3", "-resource-dir", resources,
            "-DEIGEN_MAX_ALIGN_BYTES=16", "-w"]


def find(room, paths):
    """Sites of the files of a room, which are read as one translation unit: Eigen's headers take nine tenths of the time."""
    unit = f"{room.replace('/', '_')}_mutants.cpp"
    text = "".join(f'#include "{path}"\n' for path in paths)
    parsed = cindex.Index.create().parse(unit, command_line(), [(unit, text)],
                                         cindex.TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
    errors = [str(found) for found in parsed.diagnostics if found.severity >= cindex.Diagnostic.Error]
    if errors:
        raise SystemExit("mutate: clang could not read {}:\n{}".format(room, "\n".join(errors[:10])))
    sources = {}
    for path in paths:
        # clang may name a file as it was included: from the root.
        sources[path] = sources["./" + path] = Source(path)
    for cursor in parsed.cursor.get_children():
        if cursor.kind == Kind.MACRO_INSTANTIATION and cursor.extent.start.file is not None:
            source = sources.get(cursor.extent.start.file.name)
            if source:
                source.macros.append((cursor.extent.start.offset, cursor.extent.end.offset))
    walk = Walk(sources)
    walk.top(parsed.cursor)
    return sorted(walk.sites.values(), key=lambda site: (site.path, site.start, site.end, len(site.ranges)))
