# SPDX-License-Identifier: BSD-3-Clause
"""Anisotropic quad remeshing for VTK:

    from anisotropicquadremesher import vtkAnisotropicQuadRemesher
"""
from .vtkAnisotropicQuadRemesher import vtkAnisotropicQuadRemesher

__all__ = ["vtkAnisotropicQuadRemesher"]
