#!/usr/bin/env python3
"""cpp_samples.py OUT.cpp: makes a test of the C++ samples of README.md and docs/. Whole programs are
run and must print the text block that follows them; fragments are compiled (as templates, so that
nothing need be linked) after what the comment "<!-- given: ... -->" before them declares."""

import re
import sys

import samples

HEAD = """// Made by tests/docs/cpp_samples.py from the pages of docs/.
#include <gtest/gtest.h>
"""
RUN = """
TEST(DocsSamples, {name}) {{
  testing::internal::CaptureStdout();
  {name}::program();
  EXPECT_EQ(testing::internal::GetCapturedStdout(), R"sample({output})sample");
}}
"""


def main():
    includes, body = set(), []
    for block in samples.every("cpp"):
        lines = block.text.splitlines()
        includes |= {line for line in lines if line.startswith("#include")}
        code = "\n".join(line for line in lines if not line.startswith("#include"))
        name = re.sub(r"\W", "_", f"{block.page}_{block.line}")
        place = f'#line {block.line} "{block.page}"\n'
        if "int main(" in code:
            if block.output is None:
                sys.exit(f"{block.page}:{block.line}: a program without the text that it prints")
            code = code.replace("int main()", "void program()")
            body.append(f"namespace {name} {{\n{place}{code}\n}}\n#line 1 \"made\"\n")
            body.append(RUN.format(name=name, output=block.output))
        else:
            body.append(f"namespace {name} {{\n{block.given}\ntemplate <class> void fragment() {{\n{place}{code}\n}}\n}}\n")
    text = HEAD + "".join(f"{line}\n" for line in sorted(includes)) + "\n" + "".join(body)
    with open(sys.argv[1], "w") as file:
        file.write(text)


main()
