-- transforms against sums, for even, odd and prime lengths; their inverse; GSL beside FFTW
local tap = require "tap"
local dm = require "dm"
local ok, raises = tap.ok, tap.raises

local function sums(x, y, sign)
  local n, re, im = #x, {}, {}
  for k = 0, n - 1 do
    local a, b = 0, 0
    for j = 0, n - 1 do
      local angle = sign * 2 * math.pi * (j * k % n) / n
      local c, s = math.cos(angle), math.sin(angle)
      a, b = a + x[j + 1] * c - y[j + 1] * s, b + x[j + 1] * s + y[j + 1] * c
    end
    re[k + 1], im[k + 1] = a, b
  end
  return re, im
end

local function off(a, b)
  local worst = 0
  for i = 1, #b do worst = math.max(worst, math.abs(a[i] - b[i])) end
  return worst
end

for _, n in ipairs { 1, 2, 3, 4, 7, 12, 16, 97, 101, 210, 256 } do
  local x, y = {}, {}
  for j = 1, n do x[j], y[j] = math.sin(j * j), math.cos(3 * j) end
  local re, im = dm.fft(x, y)
  local a, b = sums(x, y, -1)
  local u, v = dm.ifft(re, im)
  local worst = math.max(off(re, a), off(im, b))
  ok(worst < 1e-13 * n and off(u, x) + off(v, y) < 1e-14 * n, ("length %d"):format(n), worst)
end
local re, im = dm.fft(dm.vector { 1, 2, 3 })
ok(math.abs(re[1] - 6) < 1e-15 and math.abs(im[2] - math.sqrt(3) / 2) < 1e-15,
  "y left out is 0, and the sign is exp(-i ...)", im[2])

-- the same numbers by GSL, which a line on stderr announces
local script = [[local re, im = require "dm".fft({ 1, 2, 0, -1, 5, 0.5, 3 }, { 0, 1, 0, 0, 2, 0, 0 })
for k = 1, 7 do io.write(("%%.17g %%.17g "):format(re[k], im[k])) end]]
local function by(setting)
  local pipe = io.popen(("%s %s -e '%s' 2>&1"):format(setting, os.getenv "DMLUA" or "build/dmlua",
    (script:gsub("%%%%", "%%"))))
  local text = pipe:read "a"
  pipe:close()
  return text
end
local own, gsl = by "", by "DMLUA_FFT=no"
ok(gsl:find "libfftw3%-dev" and select(2, gsl:gsub("\n", "")) == 1, "GSL is told in one line", gsl)
local function numbers(text)
  local out = {}
  for x in text:gsub("^.*\n", ""):gmatch "%S+" do out[#out + 1] = tonumber(x) end
  return out
end
ok(#numbers(own) == 14 and off(numbers(own), numbers(gsl)) < 1e-14, "both give the same", own .. gsl)

raises("as many numbers", dm.fft, { 1, 2 }, { 1 })
raises("at least one", dm.fft, {})
raises("at least one", dm.fft, 3)
raises("finite", dm.fft, { 1, 0 / 0 })
raises("finite", dm.ifft, { 1, 2 }, { 1, 1 / 0 })
raises("must be a number", dm.fft, { 1, "x" })
tap.done()
