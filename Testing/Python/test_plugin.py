# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the plugin under pvpython: test_plugin.py PLUGIN.so XML; each is named after what would have
gone wrong."""
import sys
import unittest
import xml.etree.ElementTree as ElementTree

from paraview import servermanager
from paraview import simple as pv

PLUGIN, XML = sys.argv[1:3]
PORTS = ("Remeshed", "PrincipalDirections", "Confidence", "IntegratedLines")


class Plugin(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        pv.LoadPlugin(PLUGIN, remote=False, ns=vars(pv))

    def setUp(self):
        self.sphere = pv.Sphere(ThetaResolution=60, PhiResolution=40)
        self.filter = pv.AnisotropicQuadRemesher(Input=self.sphere)
        self.filter.Tolerance = 0.002

    def tearDown(self):
        pv.Delete(self.filter)
        pv.Delete(self.sphere)

    def test_named_ports_hold_their_data(self):
        self.filter.UpdatePipeline()
        for index, name in enumerate(PORTS):
            self.assertEqual(self.filter.SMProxy.GetOutputPortName(index), name)
            self.assertGreater(servermanager.Fetch(self.filter, idx=index).GetNumberOfCells(), 0, name)

    def test_every_property_reaches_the_filter(self):
        properties = {p.get("name"): p for p in ElementTree.parse(XML).iter() if p.tag.endswith("VectorProperty")}
        plain = self.filter.SMProxy.GetClientSideObject()
        for name, element in properties.items():
            label = element.get("label").replace(" ", "")
            self.assertEqual(label, name)
            self.assertTrue(hasattr(self.filter, name), name)
            if hasattr(plain, "Get" + name):
                self.assertAlmostEqual(float(getattr(plain, "Get" + name)()), float(self.xml_value(element)), msg=name)

    def xml_value(self, element):
        return 0.002 if element.get("name") == "Tolerance" else element.get("default_values")

    def test_every_property_is_documented(self):
        for element in ElementTree.parse(XML).iter():
            if element.tag.endswith("VectorProperty"):
                documentation = element.find("Documentation")
                self.assertIsNotNone(documentation, element.get("name"))
                self.assertGreater(len(documentation.text), 20, element.get("name"))
                self.assertGreater(len(documentation.get("short_help")), 10, element.get("name"))

    def test_every_property_is_in_a_group(self):
        root = ElementTree.parse(XML)
        grouped = {p.get("name") for g in root.iter("PropertyGroup") for p in g.iter("Property")}
        names = {p.get("name") for p in root.iter() if p.tag.endswith("VectorProperty")}
        self.assertEqual(grouped, names)

    def test_target_number_of_points_is_met(self):
        self.filter.DensityMode = "Number Of Points"
        self.filter.TargetNumberOfPoints = 1000
        self.filter.UpdatePipeline()
        points = self.filter[0].GetDataInformation().GetNumberOfPoints()
        self.assertLessEqual(abs(points - 1000), 50)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
