// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/hdf5_bridge.h"

#include <hdf5.h>

#include <type_traits>

namespace patina::ttf::hdf5 {

static_assert(std::is_same_v<Id, hid_t> && std::is_same_v<Length, hsize_t>);

namespace {

std::recursive_mutex& sharedMutex() {
  static std::recursive_mutex shared;
  return shared;
}

Handle textOf(std::size_t bytes) {
  const Id type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, bytes);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return {type, H5Tclose};
}

}  // namespace

Session::Session() : lock_(sharedMutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

bool Handle::close() {
  if (id_ < 0) return true;
  const Session session;
  return close_(std::exchange(id_, -1)) >= 0;
}

void Checker::fail(const std::string& what) const {
  throw ProcessingError(exit_, path_.string() + ": " + what);
}

Handle Checker::handle(Id id, Handle::Close close, const std::string& what) const {
  if (id < 0) fail(what);
  return {id, close};
}

Handle simpleSpace(std::initializer_list<Length> dims, std::initializer_list<Length> dims_max) {
  return {H5Screate_simple(static_cast<int>(dims.size()), dims.begin(),
                           dims_max.size() ? dims_max.begin() : nullptr),
          H5Sclose};
}

Handle halfType() {
  const Id type = H5Tcopy(H5T_IEEE_F32LE);
  H5Tset_fields(type, 15, 10, 5, 0, 10);
  H5Tset_size(type, 2);
  H5Tset_ebias(type, 15);
  return {type, H5Tclose};
}

Handle textType(std::size_t bytes) { return textOf(bytes); }

Handle anyTextType() {
  Handle type = textOf(H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

}  // namespace patina::ttf::hdf5
