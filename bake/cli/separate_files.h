// This file refuses a command that would write over what it reads, before any work is done.
#pragma once

#include <string>
#include <vector>

namespace sunbeam {

// Throws Error naming both if an output is also an input, or if two outputs are one file: by whatever names,
// links and folders they are reached. Standard output is an output too, where it is a file. Devices and FIFOs
// may be given several times.
void require_separate(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

}  // namespace sunbeam
