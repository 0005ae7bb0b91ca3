--- What a function calls the value that it computes with, (global 'K') or (local 'x'), as Lua's own
-- messages do for what it computes itself: read off the code of the function, as ldebug.c of Lua
-- 5.4 does. Only asked when an error is on its way.
local M = {}

local getinfo, getlocal = debug.getinfo, debug.getlocal

-- opcodes of Lua 5.4 (lopcodes.h)
local MOVE, LOADNIL, GETUPVAL, GETTABUP, GETTABLE, GETI, GETFIELD = 0, 8, 9, 11, 12, 13, 14
local SELF = 20
local MMBIN, JMP, CALL, TAILCALL, TFORCALL = 46, 56, 68, 69, 76
-- instructions that set no register: stores, calls of metamethods, closing, jumps, comparisons,
-- returns, the preparation of loops, SETLIST, EXTRAARG
local SETS_NONE = {}
for range in ("10-10 15-18 46-48 54-66 70-72 75-75 78-78 82-82"):gmatch "%S+" do
  local first, last = range:match "(%d+)-(%d+)"
  for o = first, last do SETS_NONE[o] = true end
end

---- the code of a function, from string.dump ----

local HEAD = "\27Lua\x54\0\x19\x93\r\n\x1a\n\4\8\8"

-- a reader of the dump behind its head
local function reader(text)
  local at = 1
  local R = {}
  function R.byte()
    at = at + 1
    return text:byte(at - 1)
  end
  function R.skip(n) at = at + n end
  function R.size()
    local x = 0
    repeat
      local b = R.byte()
      x = x << 7 | b & 0x7f
    until b & 0x80 ~= 0
    return x
  end
  function R.text()
    local n = R.size()
    if n == 0 then return end
    at = at + n - 1
    return text:sub(at - n + 1, at - 1)
  end
  function R.word()
    at = at + 4
    return (string.unpack("<I4", text, at - 4))
  end
  return R
end

-- a list of as many as the dump says, each read by `one`
local function list(R, one)
  local out = {}
  for i = 1, R.size() do out[i] = one(i) or false end
  return out
end

local function constant(R)
  local kind = R.byte()
  if kind == 0x13 or kind == 0x03 then return R.skip(8) end
  if kind == 0x04 or kind == 0x14 then return R.text() end
end

-- code, string constants, lines, local variables and names of upvalues
local function prototype(R)
  local P = {}
  R.text()
  P.line = R.size()
  R.size()
  R.skip(3)
  P.code = list(R, R.word)
  P.constants = list(R, function() return constant(R) end)
  list(R, function() R.skip(3) end)
  list(R, function() prototype(R) end)
  P.change = list(R, R.byte)  -- of the line from one instruction to the next
  P.whole = {}                -- lines where these are too far apart
  list(R, function()
    local pc = R.size()
    P.whole[pc] = R.size()
  end)
  P.locals = list(R, function() return { R.text(), R.size(), R.size() } end)
  P.upvalues = list(R, R.text)
  return P
end

local function code_of(f)
  local text = string.dump(f)
  if text:sub(1, #HEAD) ~= HEAD then return end
  return prototype(reader(text:sub(#HEAD + 18)))  -- behind two sample numbers and a count
end

---- instructions: i = opcode | A << 7 | k << 15 | B << 16 | C << 24 ----

local function op(i) return i & 0x7f end
local function A(i) return i >> 7 & 0xff end
local function B(i) return i >> 16 & 0xff end
local function C(i) return i >> 24 end

-- does instruction i set the register?
local function sets(i, register)
  local o, a = op(i), A(i)
  if SETS_NONE[o] then return false end
  if o == LOADNIL then return a <= register and register <= a + B(i) end
  if o == TFORCALL then return register >= a + 2 end
  if o == SELF then return a == register or a + 1 == register end
  if o == CALL or o == TAILCALL then return register >= a end
  return a == register
end

-- the place (from 0) of the instruction before `last` that set the register for certain, or nil
local function setter(P, last, register)
  local found, certain = nil, 0
  for pc = 0, last - 1 do
    local i = P.code[pc + 1]
    if op(i) == JMP then
      local to = pc + 1 + ((i >> 7) - 0xffffff)
      if to <= last and to > certain then certain = to end
    elseif sets(i, register) then
      found = pc >= certain and pc or nil
    end
  end
  return found
end

-- the name of the local variable in a register at an instruction
local function local_name(P, register, pc)
  for _, v in ipairs(P.locals) do
    if v[2] > pc then return end
    if pc < v[3] then
      if register == 0 then return v[1] end
      register = register - 1
    end
  end
end

-- kind and name of what is in the register before instruction `pc`
local function name_of(P, pc, register)
  local name = local_name(P, register, pc)
  if name then return "local", name end
  local at = setter(P, pc, register)
  local i = at and P.code[at + 1]
  if not i then return end
  local o = op(i)
  if o == MOVE and B(i) < A(i) then return name_of(P, at, B(i)) end
  if o == GETUPVAL then return "upvalue", P.upvalues[B(i) + 1] end
  if o == GETTABUP then
    return P.upvalues[B(i) + 1] == "_ENV" and "global" or "field", P.constants[C(i) + 1]
  end
  if o == GETFIELD then
    local _, of = name_of(P, at, B(i))
    return of == "_ENV" and "global" or "field", P.constants[C(i) + 1]
  end
  if o == SELF and register == A(i) then return "method", P.constants[C(i) + 1] end
  if o == GETTABLE or o == GETI then return "field", "?" end
end

---- where it is ----

-- is instruction `pc` (from 0) at this line?
local function is_at(P, pc, line)
  local at = P.line
  for k = 0, pc do
    local change = P.change[k + 1]
    at = change == 0x80 and P.whole[k] or at + change - (change > 0x80 and 0x100 or 0)
  end
  return at == line
end

-- numbers of events (ltm.h), behind which MMBIN has its operation
local EVENTS = { add = 6, sub = 7, mul = 8, mod = 9, pow = 10, div = 11, idiv = 12 }

-- is it certain that what a function has under this name is not nil?
local function has_value(f, kind, name)
  if kind ~= "global" then return false end
  for k = 1, 255 do
    local upvalue, env = debug.getupvalue(f, k)
    if not upvalue then return false end
    if upvalue == "_ENV" then return type(env) == "table" and rawget(env, name) ~= nil end
  end
end

-- What the function at `level` calls the nil among the operands of the event, or nothing. Registers
-- serve again along a line: operations of this event whose operands may be these must agree.
local function found(level, event, first, second)
  local at = getinfo(level + 1, "fl")
  local P, kind, name = code_of(at.func), nil, nil
  for k, i in ipairs(P and P.code or {}) do
    if op(i) == MMBIN and C(i) == (EVENTS[event] or C(i)) and is_at(P, k - 1, at.currentline) then
      local _, x = getlocal(level + 1, A(i) + 1)
      local _, y = getlocal(level + 1, B(i) + 1)
      local its_kind, its_name = name_of(P, k - 2, first == nil and A(i) or B(i))
      local may_be = (x == nil) == (first == nil) and (y == nil) == (second == nil)
        and not has_value(at.func, its_kind, its_name)
      if may_be and name and its_name ~= name then return end
      if may_be then kind, name = its_kind, its_name end
      if may_be and kind == "global" then break end -- it is nil, and comes first
    end
  end
  return name and (" (%s '%s')"):format(kind, name)
end

--- " (global 'K')": the nil that the metamethod at `level` of the caller was called with, by the
-- name that the function which called it has for it; "" where that cannot be told.
function M.of_nil(level)
  level = level + 1
  local called = getinfo(level, "n") or {}
  if called.namewhat ~= "metamethod" then return "" end
  local _, first = getlocal(level, 1)
  local _, second = getlocal(level, 2)
  local caller = getinfo(level + 1, "S")
  if not caller or caller.what == "C" or (first == nil) == (second == nil) then return "" end
  local fine, text = pcall(found, level + 2, called.name, first, second)  -- pcall is a level, too
  return fine and text or ""
end

---- arguments ----

-- kind and name of argument `arg` of the function `called`, which the one at `level` calls; nothing
-- where calls at this line differ in it
local function argument_of(level, called, arg)
  local at = getinfo(level + 1, "fl")
  local P = code_of(at.func)
  local kind, name
  for k, i in ipairs(P and P.code or {}) do
    if (op(i) == CALL or op(i) == TAILCALL) and (B(i) == 0 or B(i) > arg)
      and is_at(P, k - 1, at.currentline) and select(2, name_of(P, k - 1, A(i))) == called then
      local its_kind, its_name = name_of(P, k - 1, A(i) + arg)
      if name and its_name ~= name and not has_value(at.func, its_kind, its_name) then return end
      if its_name and not has_value(at.func, its_kind, its_name) then
        kind, name = its_kind, its_name
      end
    end
  end
  return kind, name
end

--- Kind and name, "global" and "K", of the nil that is argument `arg` of the function in C at
-- `level` of the caller, by what the function that called it has; nothing where that is unknown.
function M.of_argument(level, arg)
  level = level + 1
  local called, caller = getinfo(level, "n").name, getinfo(level + 1, "S")
  if not called or not caller or caller.what == "C" then return end
  local fine, kind, name = pcall(argument_of, level + 2, called, arg)  -- pcall is a level, too
  if fine and name and name ~= "?" then return kind, name end
end

return M
