--- Where runs of fields ended whose steps are asynchronous or over uneven slices, as kinds of
-- dm.data.checkpoint.
local checkpoint = require "dm.data.checkpoint"
local core = require "dm.core"
local option = require "dm.base.options"
local state_file = require "dm.data.state_file"

local M = {}

local fingerprint = state_file.fingerprint

local ends = setmetatable({}, { __mode = "k" }) -- by path

--- Where the run of a path ended: { kind = "avi" | "prismal", ... }.
function M.keep(path, ending) ends[path] = ending end

--- Rows before that which a full disk did not take, where a run goes on from a path that had some.
function M.missing(from)
  return type(from) == "userdata" and ends[from].missing or nil
end

-- 1 where a value is held, else 0
local function marks(f)
  local out = core.constant(f.n, 0)
  for i = 1, f.n do out[i] = f.held[i] and 1 or 0 end
  return out
end

-- dL/dq and forces at some q and v, and what holds and weighs the values: of the model that a path
-- was stepped with, or of the system as it is now; and what the system computes at any q and v
local function same(system, path)
  local f, of = system.field, path or system
  local q = core.constant(f.n, 0)
  for i = 1, f.n do q[i] = 0.4 * math.sin(1.7 * i) end
  local v = (f.force or f.absorbing) and q or nil
  local forces = (f.force and "force" or "") .. (f.absorbing and "absorbing" or "")
  return { { "degree", f.degree }, { "cells", f.cells }, { "values", f.values },
    { "fixed", fingerprint(marks(f)) }, { "masses", fingerprint((core.field_masses(of))) },
    { "forces", forces == "" and "none" or forces },
    { "L", fingerprint(core.field_force(of, q, 0.3, v)) }, { "model", core.fingerprint(of) } }
end

-- the last row of a run is where it ended
local function kind_of(name, what, ending, sizes, solver)
  return { head = "dmlua " .. name .. " 2", what = what, where = "dm.resume", name = "the field",
    run = "dm.path", of = "system", same = same, sizes = sizes, solver = solver,
    ending = function(path) return ending(ends[path]) end }
end

M.KINDS = {
  avi = kind_of("avi", "a run of asynchronous steps", function(e)
    return { { "start", e.start }, { "t0", e.t0 * 1.0 }, { "t", e.t * 1.0 }, { "steps", #e.h } },
      { e.h, e.state }
  end, function(system, read)
    local cells = read:count "steps"
    return { cells, 3 * system.field.n + cells }
  end, function(system, read, vectors, options)
    if options ~= nil then
      option.fail("dm.resume", "asynchronous steps go on as they were: there are no options")
    end
    local s = system:solver { rule = "avi", h = vectors[1], start = read:text "start" }
    local q = {}
    for i = 1, system.field.n do q[i] = vectors[2][i] end
    s.ending = { t = read:number "t", t0 = read:number "t0", h = s.h, state = vectors[2], q = q }
    return s
  end),

  prismal = kind_of("prismal", "a run over slices", function(e)
    return { { "done", e.done }, { "slices", #e.times }, { "sums", e.sums or "compensated" } },
      { e.times, e.state }
  end, function(_, read)
    local times = read:count "slices"
    return { times, #read.fields.state - times }
  end, function(system, read, vectors, options)
    return require "dm.dec.fields.prismal".resume(system, { done = read:count "done",
      times = vectors[1], state = vectors[2], sums = read:text "sums" }, options)
  end),
}

--- Raises where the field is another one by now than that of the run that a solver goes on from.
function M.check_still(kind, solver)
  checkpoint.check_still(M.KINDS[kind], solver.system, solver)
end

--- The kind of what goes on from a path or a file, or nil: it is one of the core's.
function M.kind_of(from)
  local ending = type(from) == "userdata" and ends[from]
  if ending then return M.KINDS[ending.kind] end
  local head = type(from) == "string" and state_file.head(from)
  for _, kind in pairs(M.KINDS) do
    if kind.head == head then return kind end
  end
end

return M
