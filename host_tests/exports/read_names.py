#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Reads every export N.FORMAT of the arm called as N.name says, in this folder.

read_names.py legal|illegal: a legal name has to come back as it was; of an illegal one, which only
our own code could have put there, nothing but text may come out. Exits with 1 and words otherwise.
"""
import ast
import glob
import json
import sys
import unicodedata
import xml.parsers.expat

import yaml

STATEMENTS = [ast.Import, ast.ImportFrom, ast.ImportFrom, ast.Assign, ast.Assign, ast.Assign,
              ast.Assign, ast.FunctionDef]


def python_name(data):
    compile(data, "rtb", "exec")  # from bytes, as python3 FILE reads it: a stated encoding counts
    module = ast.parse(data)
    assert [type(node) for node in module.body] == STATEMENTS, ast.dump(module)
    return next(word.value.value for node in ast.walk(module) if isinstance(node, ast.Call)
                for word in node.keywords if word.arg == "name")


def urdf_name(data):
    seen = []
    parser = xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = lambda name, attributes: seen.append((name, attributes))
    parser.Parse(data, True)
    assert {name for name, _ in seen} == {"robot", "link", "joint", "parent", "child", "origin",
                                          "axis", "limit"}, {name for name, _ in seen}
    assert [name for name, _ in seen].count("robot") == 1
    return seen[0][1]["name"]


def ur_yaml(data):
    document = yaml.safe_load(data)
    assert list(document) == ["kinematics"], list(document)
    assert list(document["kinematics"]) == ["shoulder", "upper_arm", "forearm", "wrist_1",
                                            "wrist_2", "wrist_3", "hash"]


def csv(data):
    # Every way in which a reader may end a line: str.splitlines knows them all.
    lines = data.decode().splitlines()
    table = [line for line in lines if not line.startswith("#")]
    assert len(table) == 7 and table[0].startswith("joint,type,"), table
    for line in lines:
        if line.startswith("#"):
            for cell in line.replace(";", ",").split(",")[1:]:
                assert not cell.lstrip().startswith(("=", "+", "@")), line


def hal(data):
    for line in data.decode().splitlines():
        assert line.startswith(("# ", "loadrt offset names=", "setp genserkins.",
                                "setp joint-offset.", "addf joint-offset.", "net joint-")), line
        assert len(line.encode()) < 1000, "halcmd reads 1024 bytes a line"
        assert not line.endswith("\\"), "halcmd goes on in the next line"


def kins(data):
    lines = data.decode().splitlines()
    assert lines[0] == "armsig linuxcnc-kins/1" and lines[-1].startswith("crc32 0x"), lines
    for line in lines[1:-1]:
        assert line.startswith(("# ", "joint revolute ", "tip ")), line


def json_name(data):
    document = json.loads(data)
    assert document["serial"] == document["name"], (document["serial"], document["name"])
    return document["name"]


def check_characters(data):
    for character in data.decode():
        assert character == "\n" or unicodedata.category(character) not in ("Cc", "Zl", "Zp"), data
        assert character not in "\u202a\u202b\u202c\u202d\u202e\ufeff", data


def main(legal):
    readers = {"rtb": python_name, "urdf": urdf_name, "json": json_name, "ur-yaml": ur_yaml,
               "linuxcnc": hal, "linuxcnc-kins": kins, "dh-csv": csv, "mdh-csv": csv}
    names = sorted(glob.glob("*.name"))
    assert names
    for path in names:
        with open(path, "rb") as file:
            name = file.read()
        for form, read in readers.items():
            with open(path.replace("name", form), "rb") as file:
                data = file.read()
            try:
                check_characters(data)
                got = read(data)
                if legal and got is not None:
                    assert got == name.decode(), got
            except Exception as fault:
                sys.exit(f"{form} of {name!r}: {type(fault).__name__}: {fault}")


if __name__ == "__main__":
    main(sys.argv[1] == "legal")
