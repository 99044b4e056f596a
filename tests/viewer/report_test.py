#!/usr/bin/env python3
"""report_test.py CULLHULL: the reports of cullhull-bench, opened in a browser from file://."""
import json
import unittest

import pages
from pages import bench, path


def setUpModule():
    global browser
    browser = pages.begin()


def tearDownModule():
    pages.end()


class Report(unittest.TestCase):
    """`cullhull-bench ... --report`, small: charts and numbers are the JSON's."""

    def test_charts_and_numbers(self):
        page, report = path("report.html"), path("report.json")
        bench("paper", "--scale", "0.0005", "--repeat", "1", "-q", "--report", page,
            f"--json={report}")
        with open(report) as file:
            figures = json.load(file)["figures"]
        browser.screen(1000, 900)
        self.assertEqual(browser.open(page), [])
        self.assertEqual(browser.run("return document.querySelectorAll('#figures svg').length"),
                         len(figures))
        for figure in figures:
            cells, marks, titles = browser.run(
                "const s = document.getElementById(arguments[0]);"
                "return [[...s.querySelectorAll('td[data-value]')].map(c => c.dataset.value),"
                " s.querySelectorAll('rect, circle').length,"
                " [...s.querySelectorAll('th')].map(h => h.textContent)]", figure["id"])
            names = []
            for row in figure["rows"]:
                names += [name for name in row["values"] if name not in names]
            values = [row["values"].get(name) for row in figure["rows"] for name in names]
            self.assertEqual([json.loads(c) for c in cells], values, figure["id"])
            self.assertEqual(marks, sum(v is not None for v in values), figure["id"])
            # Nothing is named that was not run.
            legend = browser.run(
                "return document.getElementById(arguments[0]).querySelectorAll('.legend span').length",
                figure["id"])
            self.assertGreater(legend, 0)
            for row in figure["rows"]:
                self.assertIn(row["name"], titles)
        light = browser.picture("figures").getpixel((2, 60))
        browser.screen(1000, 900, dark=True)
        self.assertGreater(sum(light), 600)
        self.assertLess(sum(browser.picture("figures").getpixel((2, 60))), 300)
        browser.doing(lambda: browser.screen(390, 844))
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), 390)

    def test_rivals(self):
        """What is marked on the page is what the JSON marks; on paper the numbers are unfolded."""
        page, report = path("rivals.html"), path("rivals.json")
        bench("rivals", "--scale", "1", "--repeat", "1", "-q", "--report", page,
            f"--json={report}", "--limit", "0.05", "--threads", "1", "--workload", "sphere-2d-300",
            "--workload", "cube-surface-3d-2k", "--workload", "sphere-3d-100k")
        with open(report) as file:
            figures = json.load(file)["figures"]
        browser.screen(1000, 900)
        self.assertEqual(browser.open(page), [])
        for figure in figures:
            texts, cells = browser.run(
                "const s = document.getElementById(arguments[0]);"
                "return [[...s.querySelectorAll('svg text')].map(t => t.textContent),"
                " [...s.querySelectorAll('td:last-child')].map(c => [c.textContent, c.className])]",
                figure["id"])
            for row, (check, marked) in zip(figure["rows"], cells, strict=True):
                self.assertIn(row["check"], check)
                self.assertEqual(marked == "differs", bool(row["slower"]) or not row["agrees"])
                self.assertEqual(any(t.startswith(row["name"]) for t in texts), True)
            stopped = sum(len(row["unfinished"]) for row in figure["rows"])
            self.assertEqual(sum(t.startswith("> 50.0 ms") for t in texts), stopped)
        opened = "return [...document.querySelectorAll('details')].map(d => d.open)"
        browser.run("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(browser.run(opened), [True] * len(figures))
        browser.run("window.dispatchEvent(new Event('afterprint'))")
        self.assertEqual(browser.run(opened), [False] * len(figures))
        browser.doing(lambda: browser.screen(390, 844))
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), 390)
        wide = browser.run(
            "return [...document.querySelectorAll('svg')].every(s => [...s.querySelectorAll('text')]"
            ".every(t => t.getBoundingClientRect().right <= s.getBoundingClientRect().right))")
        self.assertTrue(wide, "words run out of a chart")


if __name__ == "__main__":
    pages.require()
    unittest.main(verbosity=2)
