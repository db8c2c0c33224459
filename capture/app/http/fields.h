// SPDX-License-Identifier: GPL-3.0-or-later
// The header fields and the query of a request, as text in, answer out: nothing here knows a
// socket.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patina::http {

// What Host may say: localhost, 127.0.0.1, [::1] and the configured names, each with the port; the
// configured ones also without it when a proxy or the scheme's own port may hide it.
std::vector<std::string> allowedHosts(int port, const std::vector<std::string>& names,
                                      bool port_may_be_hidden);
// Exact but for the case of ASCII letters. A name that merely resolves to us is not ours: that is
// how DNS rebinding comes in.
bool hostAllowed(std::string_view host, const std::vector<std::string>& allowed);

// May a page's script or form have sent this? Sec-Fetch-Site decides where there is one; else
// Origin must be one of ours (scheme, host and port); a request with neither is no browser's.
bool fromOurSite(std::optional<std::string_view> sec_fetch_site,
                 std::optional<std::string_view> origin, std::string_view scheme,
                 const std::vector<std::string>& hosts);

// The value of the first cookie of that name, without quotes; nothing when there is none.
std::optional<std::string> cookieValue(std::string_view header, std::string_view name);
// Of "Bearer TOKEN", 1 to 256 bytes of RFC 6750's b64token.
std::optional<std::string> bearerToken(std::string_view header);
// application/json, with no charset or utf-8.
bool isJsonType(std::string_view content_type);

// Percent-decoded, '+' as a space. Nothing when a percent sign is followed by no two hexadecimal
// digits, or a zero byte comes out.
std::optional<std::string> percentDecoded(std::string_view text);
// "a=1&b": at most 32 pairs; a name twice, or anything that cannot be decoded: nothing.
std::optional<std::map<std::string, std::string>> parseQuery(std::string_view query);

}  // namespace patina::http
