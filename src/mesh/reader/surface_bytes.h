/// @file
/// Room `mesh` (private): surface files as some programs write them, in the bytes that assimp reads as others read the file.
#pragma once

#include <string>

namespace tissue_contact {

/// The bytes of an STL or OBJ file, where they are to be read in place of the file's own; empty where those will do, and for
/// every other ending. Of what a surface needs nothing is changed: corners keep their digits.
/// STL: keywords in capitals; blank lines, or a byte-order mark, before the first; a first name that is longer than assimp
/// takes; normals, which nobody uses, that are no numbers to assimp (Microsoft's "-1.#IND" and "-nan(ind)"); a few bytes
/// behind the triangles of a binary one. OBJ: a byte-order mark; comments behind vertices and faces; seven numbers a vertex
/// (x y z r g b a), which assimp leaves out, so that faces name vertices that are not there.
/// @param ending of the file's name, lower case, without the dot.
/// @throws as readFile() does.
std::string otherBytes(const std::string& file, const std::string& ending);

}  // namespace tissue_contact
