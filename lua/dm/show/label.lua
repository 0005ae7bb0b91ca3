--- Texts of pictures: names as they are set in print, q_1, p_theta, 10^{-3}, and all else as it
-- stands. What a text says is never run: gnuplot gets its own signs by number.
local axis = require "dm.show.axis"

local M = {}

local GREEK = { alpha = "α", beta = "β", gamma = "γ", delta = "δ", epsilon = "ε", zeta = "ζ",
  eta = "η", theta = "θ", iota = "ι", kappa = "κ", lambda = "λ", mu = "μ", nu = "ν", xi = "ξ",
  pi = "π", rho = "ρ", sigma = "σ", tau = "τ", upsilon = "υ", phi = "φ", chi = "χ", psi = "ψ",
  omega = "ω", Gamma = "Γ", Delta = "Δ", Theta = "Θ", Lambda = "Λ", Xi = "Ξ", Pi = "Π",
  Sigma = "Σ", Phi = "Φ", Psi = "Ψ", Omega = "Ω" }

--- A string as gnuplot reads it back. Between double quotes it reads these, backslashes and
-- commands in backquotes, so they are given by number; single quotes are no way, as it takes two of
-- them at the begin of a string for an empty one.
function M.quote(text)
  local function octal(c) return ("\\%03o"):format(c:byte()) end
  return '"' .. text:gsub('[%c"\\`]', octal) .. '"'
end

-- what gnuplot would take for a sign of its own, after a backslash
local function escaped(text) return (text:gsub("[{}^_@&~\\]", "\\%0")) end

-- names may be indices' and powers' bases: one letter, or a Greek one
local function is_base(word) return #word == 1 or GREEK[word] ~= nil end

local marked

-- the index or power at `at`, behind its sign: { braces }, or letters and digits; nothing where
-- there is none
local function group(text, at, pattern)
  local inside = text:match("^%b{}", at)
  if inside then return marked(inside:sub(2, -2)), at + #inside end
  inside = text:match(pattern, at)
  if inside then return marked(inside), at + #inside end
end

-- with gnuplot's marks
function marked(text)
  local out, at, base = {}, 1, false
  while at <= #text do
    local word, sign = text:match("^%a+", at), text:sub(at, at)
    local inside, after
    if sign == "_" and base then
      inside, after = group(text, at + 1, "^%w+")
    elseif sign == "^" and at > 1 then
      inside, after = group(text, at + 1, "^%-?[%w]+")
    end
    if inside then
      out[#out + 1] = sign .. "{" .. inside .. "}"
      at, base = after, true
    elseif word then
      out[#out + 1] = GREEK[word] or word
      at, base = at + #word, is_base(word)
    else
      out[#out + 1] = escaped(sign)
      base = base and sign:find "%d" ~= nil
      at = at + 1
    end
  end
  return table.concat(out)
end

-- bytes that are no UTF-8 would make an SVG unreadable
local function readable(text)
  text = tostring(text)
  if not utf8.len(text) then text = text:gsub("[\128-\255]", "?") end
  return (text:gsub("%c", " "))
end

--- A text as gnuplot reads it, with indices, powers and Greek letters; plain: as it stands.
function M.caption(text, plain)
  text = readable(text)
  return M.quote(plain and escaped(text) or marked(axis.raised(text)))
end

--- The same of a scale that goes up, on its right: a name of up to three letters stands upright,
-- since a lone u, w or p that lies on its side is read as another sign.
function M.upright(text)
  return M.caption(text) .. ((utf8.len(text) or 4) <= 3 and " offset 1.5,0 norotate" or "")
end

return M
