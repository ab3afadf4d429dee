// SPDX-License-Identifier: BSD-3-Clause
#ifndef PluginStart_h
#define PluginStart_h

// Run when ParaView loads the plugin: complains when that is another ParaView than the one the plugin was
// built for, and teaches it colors and names of the types of lines.
void StartAnisotropicQuadRemesherPlugin();

#endif
