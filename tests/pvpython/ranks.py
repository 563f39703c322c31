"""Several processes, each with its part of the volume: the list of labels is complete in all.

`pvpython ranks.py VOLUME` writes the volume, `mpiexec -n 3 pvbatch ranks.py PLUGIN VOLUME` checks.
"""
import sys

import numpy as np
from paraview import servermanager, simple

from pipeline import image
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter


def write(path):
    volume = np.zeros((24, 16, 20), np.int16)
    volume[:8, 6:10, 2:-2] = -7
    volume[8:16, 6:10, 2:-2] = 1
    volume[16:, 6:10, 2:-2] = 200
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image(volume))
    writer.SetDataModeToBinary()
    writer.Write()


def check(path, plugin):
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))
    ranks = servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
    reader = simple.XMLImageDataReader(FileName=[path])
    reader.UpdatePipeline()
    proxy = simple.MidSurface(Input=reader)
    proxy.UpdatePipelineInformation()
    expected = ["-7", "1", "200"]
    assert list(proxy.Labels.Available) == expected, list(proxy.Labels.Available)
    assert list(proxy.Labels) == expected, list(proxy.Labels)
    for chosen in (["200"], ["-7"], expected):
        proxy.Labels = chosen
        proxy.UpdatePipeline()
        low, high = proxy.CellData["Label"].GetRange(0)
        assert (low, high) == (int(chosen[0]), int(chosen[-1])), (low, high, chosen)
    print(f"labels are complete with {ranks} processes")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        write(sys.argv[1])
    else:
        check(sys.argv[2], sys.argv[1])
