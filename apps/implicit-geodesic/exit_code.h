/// Exit codes of the process (docs/formats.md).
#pragma once

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kUnusable = 3, kUnreached = 4 };
