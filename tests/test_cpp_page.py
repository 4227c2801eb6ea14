"""notebooks/Cpp.md: its programs are programs, and its table quotes them."""

from __future__ import annotations

import ast
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

NOTEBOOKS = Path(__file__).parents[1] / 'notebooks'
PAGE = (NOTEBOOKS / 'Cpp.md').read_text('utf-8')
# As much of rclcpp as the page uses: no wheel has the library itself.
RCLCPP = """
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <string>
namespace rclcpp {
struct Logger {};
struct TimerBase { using SharedPtr = std::shared_ptr<TimerBase>; };
template <class T> struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher<T>>;
  void publish(const T &) {}
};
struct Node {
  explicit Node(const std::string &) {}
  template <class T> std::shared_ptr<Publisher<T>> create_publisher(const std::string &, int);
  TimerBase::SharedPtr create_wall_timer(std::chrono::nanoseconds, std::function<void()>);
  Logger get_logger() const;
};
void init(int, char const * const *);
void spin(std::shared_ptr<Node>);
}
#define RCLCPP_INFO(logger, ...) (static_cast<void>(logger), std::printf(__VA_ARGS__))
"""
STRING = """
#pragma once
#include <string>
namespace std_msgs::msg { struct String { std::string data; }; }
"""


def program(language: str) -> str:
    found = re.search(rf'```{language}\n(.*?)```', PAGE, re.DOTALL)
    assert found is not None
    return found[1]


def test_each_line_of_the_table_is_in_the_programs() -> None:
    rows = re.findall(r'^\| `(.+?)` \| `(.+?)` \|', PAGE, re.MULTILINE)
    assert len(rows) >= 8
    for python, cpp in rows:
        assert python in program('python')
        assert cpp in program('cpp')


def test_the_python_is_that_of_the_lesson_on_packages() -> None:
    (path,) = NOTEBOOKS.glob('11_*.ipynb')
    cells = json.loads(path.read_text('utf-8'))['cells']
    (talker,) = (''.join(cell['source']) for cell in cells if cell['id'] == 'talker')
    page, lesson = (
        next(n for n in ast.parse(text).body if isinstance(n, ast.ClassDef)).body[0]
        for text in (program('python'), talker.partition('\n')[2])
    )
    assert ast.dump(page) == ast.dump(lesson)


def test_a_compiler_takes_the_cpp(tmp_path: Path) -> None:
    compiler = shutil.which('g++') or shutil.which('clang++')
    if compiler is None:
        pytest.skip('no compiler of C++')
    for name, text in (('rclcpp/rclcpp.hpp', RCLCPP), ('std_msgs/msg/string.hpp', STRING)):
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    source = tmp_path / 'talker.cpp'
    source.write_text(program('cpp'))
    command = [
        compiler,
        '-std=c++17',
        '-Wall',
        '-Werror',
        '-fsyntax-only',
        f'-I{tmp_path}',
        str(source),
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_lesson_links_to_it() -> None:
    (path,) = NOTEBOOKS.glob('11_*.ipynb')
    assert '](Cpp.md)' in path.read_text('utf-8')
