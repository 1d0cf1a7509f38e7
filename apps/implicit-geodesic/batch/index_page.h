/// The pages and pictures of a batch on one page.
#pragma once

#include <string>

#include "batch/plan.h"
#include "batch/summary.h"

/// HTML with a tile per job of the summary: its name, what became of it, and links to its files. A
/// tile shows the picture of the job's page, which is copied, or else that of --image, which is
/// linked.
/// @param file  of the page; links are relative to its folder
/// Time: that of reading the beginnings of the pages.
std::string indexPage(const BatchPlan& plan, const Summary& summary, const std::string& file);
