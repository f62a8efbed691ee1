#pragma once

#include <span>
#include <string>
#include <vector>

#include "io/formats.hpp"
#include "io/ply_header.hpp"

namespace shapelight::io {

/// Lists of numbers, one per row of an element, end to end.
template <class T>
struct RowLists {
  std::vector<std::uint64_t> ends;  ///< of each row's items within `items`
  std::vector<T> items;

  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const T> row(std::size_t i) const {
    const std::uint64_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span<const T>(items).subspan(begin, ends[i] - begin);
  }
};

/// What one element of the body holds, as far as anybody asked for it.
struct PlyRows {
  std::vector<Column> columns;  ///< the scalars, in file order
  RowLists<Index> indices;      ///< vertex_indices or vertex_index; -1 becomes kNoIndex
  RowLists<float> texcoords;    ///< texcoord
  bool has_indices = false;
};

/// Decodes the elements of a body in file order. Every read is checked against the bytes that are left.
class PlyBody {
 public:
  virtual ~PlyBody() = default;
  /// The element's scalars, index lists and texcoords; warns about other lists, which are skipped.
  virtual PlyRows read(const PlyElement& element, std::vector<std::string>& warnings) = 0;
  /// Steps over the element.
  virtual void skip(const PlyElement& element) = 0;
};

/// `scanner` stands behind the header and must outlive the body.
[[nodiscard]] std::unique_ptr<PlyBody> open_ply_body(const Source& source, const PlyHeader& header,
                                                     TextScanner& scanner);

}  // namespace shapelight::io
