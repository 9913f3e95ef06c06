// This file reads the JSON of a glTF file and the numbers that it describes.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sunbeam {

using Json = nlohmann::json;

// These return a part of an object, and throw Error if it is missing or something else. Naturals are whole
// numbers from 0 to 2^40, so that a sum or product of a few does not overflow.
std::size_t natural(const Json& value, const char* name);
std::size_t natural(const Json& object, const char* key, std::size_t fallback);
std::vector<std::size_t> naturals(const Json& object, const char* key);  // {} if the key is missing
std::vector<double> numbers(const Json& object, const char* key, std::size_t count);
const Json& required(const Json& object, const char* key);

class GltfDocument {
 public:
  // Takes the bytes of a .gltf or .glb file. Buffers are read as they are needed, from folders[0] and below;
  // a path may lead to the other folders too. Functions throw Error without the file's name, or what the
  // JSON library throws.
  GltfDocument(std::string_view bytes, std::vector<std::string> folders);

  std::uint64_t file_bytes() const { return file_bytes_; }  // with all buffers read so far
  bool has(const char* list) const { return json_.contains(list); }
  std::size_t size(const char* list) const;
  const Json& entry(const char* list, std::size_t index) const;
  const Json& entry(const char* list, const Json& index) const { return entry(list, natural(index, list)); }
  std::size_t default_scene() const { return natural(json_, "scene", 0); }

  // Returns all numbers of an accessor of this type, "SCALAR" to "MAT4", entry by entry.
  std::vector<double> values(const Json& accessor, const char* type);
  // Returns those of an accessor of whole numbers below `count`; `name` says in messages what they count.
  std::vector<std::uint32_t> indices(const char* name, const Json& accessor, const char* type,
                                     std::size_t count);

  // Counts numbers that are read or made. Throws Error if they are more than read_limit() allows: a small
  // file can show one mesh a million times, which costs time as well.
  void count_numbers(std::size_t numbers);

 private:
  struct Elements {
    const char* data;
    std::size_t stride;
  };

  void read_glb(std::string_view bytes);
  void require_known() const;
  const std::string& buffer(std::size_t index);
  const std::string& bytes_of(const Json& buffer, std::size_t index);
  Elements elements(const Json& source, std::size_t size, std::size_t count);
  void put_sparse(const Json& accessor, std::size_t components, std::vector<double>& values);

  std::vector<std::string> folders_;
  std::uint64_t file_bytes_;
  std::uint64_t numbers_ = 0;
  Json json_;
  std::string binary_;  // of a .glb
  bool is_glb_ = false;
  std::map<std::size_t, std::string> data_;   // of buffers in data URIs
  std::map<std::string, std::string> files_;  // by path
};

}  // namespace sunbeam
