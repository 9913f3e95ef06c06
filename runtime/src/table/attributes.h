// This file says how a table's file states numbers, axes, wavelengths and films as text attributes. Every
// function throws Error that names the attribute or the axis; from_parts() of table_parts.h adds the file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sunbeam/detail/axis.h"
#include "sunbeam/detail/wavelengths.h"
#include "sunbeam/material.h"

namespace sunbeam {
inline namespace v1 {

// Keys are without the prefix.
using Attributes = std::map<std::string, std::string>;
inline constexpr const char* kAttributePrefix = "sunbeam.";

// Returns the text of an attribute that must be there.
const std::string& require(const Attributes& attributes, std::string_view key);
// Returns finite numbers, separated by single spaces.
std::vector<double> parse_numbers(const Attributes& attributes, const std::string& key);
void require_in(const std::string& key, const std::vector<double>& values, const Interval& allowed);

// These write axes as attributes of one array, and read them back.
Attributes describe_axes(const std::vector<Axis>& axes);
std::vector<Axis> parse_axes(const Attributes& attributes, const std::string& array_name);

// These write the wavelengths of a factored table without its film, and read them back.
Attributes describe_wavelengths(const Wavelengths& wavelengths);
Wavelengths parse_wavelengths(const Attributes& attributes);

// Writes a film of layers and a base that has indices of its own; of a film that Material describes there is
// nothing to write. Layers are as thick at every wavelength.
Attributes describe_film(const Wavelengths& wavelengths);
// Reads them, at wavelengths that are there already. Ranges are those of sunbeam/detail/table_ranges.h.
void parse_film(const Attributes& attributes, Wavelengths& wavelengths);
// Throws Error if there are attributes of a film or base other than this.
void refuse_stray_film(const Attributes& attributes, const Wavelengths& wavelengths);

}  // namespace v1
}  // namespace sunbeam
