/// All of igeo: the public classes first.
#pragma once

#include <igeo/distance.h>
#include <igeo/geodesic_solver.h>
#include <igeo/surface.h>
#include <igeo/view.h>
#include <igeo/warnings.h>

#include <igeo/base/version.h>
#include <igeo/io/annotation_file.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/openvdb_interrupter.h>
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/point_list.h>
#include <igeo/io/vdb_read.h>
#include <igeo/io/vdb_write.h>
#include <igeo/io/vertex_data_file.h>
#include <igeo/io/volume_file.h>
#include <igeo/results/color_map.h>
#include <igeo/results/curve_files.h>
#include <igeo/results/engrave.h>
#include <igeo/results/extend.h>
#include <igeo/results/farthest_points.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/isolines.h>
#include <igeo/results/log_map.h>
#include <igeo/results/overrun_seeds.h>
#include <igeo/results/picture.h>
#include <igeo/results/surface_files.h>
#include <igeo/results/view_page.h>
#include <igeo/results/voronoi_cells.h>
#include <igeo/surface/rebuild.h>
#include <igeo/surface/volume_mesh.h>
