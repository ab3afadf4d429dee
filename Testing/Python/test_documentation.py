# SPDX-License-Identifier: BSD-3-Clause
"""test_documentation.py SOURCE_DIRECTORY: every public property is documented in the header, in the panel and in the
guide; every option of the C library in aqr.h; every picture of the guide is there."""
import os
import re
import sys
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = sys.argv[1]


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


HEADER = read("Filters/vtkAnisotropicQuadRemesher.h")
PROPERTIES = re.findall(r"vtkGetMacro\((\w+),", HEADER)


class Documentation(unittest.TestCase):
    def test_every_property_has_a_comment_with_its_default(self):
        self.assertGreater(len(PROPERTIES), 15)
        for name in PROPERTIES:
            before = HEADER[: HEADER.index("vtkGetMacro(%s," % name)]
            comment = before[before.rindex("///@{") :]
            self.assertRegex(comment, r"/\*\*[\s\S]+\*/", name)
            self.assertRegex(comment, r"[Dd]efault", name)

    def test_every_property_is_in_the_panel(self):
        root = ElementTree.fromstring(read("ParaViewPlugin/Plugin/AnisotropicQuadRemesher.xml"))
        names = {p.get("name") for p in root.iter() if p.tag.endswith("VectorProperty")}
        self.assertEqual(set(PROPERTIES) - names, set())

    def test_every_property_is_in_the_guide(self):
        guide = read("docs/user-guide.md")
        for name in PROPERTIES:
            self.assertIn("`%s`" % name, guide)

    def test_every_picture_of_the_guide_is_there(self):
        for document in ("docs/user-guide.md", "README.md"):
            for picture in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", read(document)):
                path = os.path.join(ROOT, os.path.dirname(document), picture)
                self.assertTrue(os.path.exists(path), picture)

    def test_every_parameter_that_shapes_the_mesh_has_a_picture(self):
        guide = read("docs/user-guide.md")
        # The first is what the next two are; the others tell of ports and threads, or need an array.
        unseen = {"DensityMode", "UseDensityArray", "UseLockArray", "FeatureAngle", "NumberOfThreads", "GenerateDirections",
                  "GenerateConfidence", "GenerateLines"}
        for name in set(PROPERTIES) - unseen:
            self.assertIn("(images/%s.png)" % name, guide)

    def test_every_option_of_the_c_library_has_a_comment(self):
        text = read("Filters/Kernels/aqr.h")
        options = text[text.index("typedef struct aqr_options") : text.index("} aqr_options;")]
        for member in re.findall(r"(\w+);", re.sub(r"/\*.*?\*/", "", options, flags=re.S)):
            self.assertRegex(options, r"\b%s;\s*/\*\*<" % member)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
