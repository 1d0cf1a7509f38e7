/// One page with the pages and pictures of a batch.
#pragma once

#include <string>

#include "batch/plan.h"
#include "batch/summary.h"

/// HTML with a tile per job of the summary: its name, its status, and links to its files. A tile
/// contains a copy of the picture in the job's page, or else a link to that of --image.
/// @param file  of the page; links are relative to its folder
/// Time: that of reading the beginnings of the pages.
std::string indexPage(const BatchPlan& plan, const Summary& summary, const std::string& file);
