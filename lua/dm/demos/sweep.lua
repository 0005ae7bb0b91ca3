-- a sweep that is stopped and taken up again
return {
  title = "Sweeps that survive: journals",
  about = [[A study of many members, each a run of its own, in processes of their own. Finished
    members are kept in a journal: after a crash the same call runs only what is missing, and
    returns the same bits.]],
  numbers = { { name = "members", value = 200, least = 10, most = 5000, what = "how many" } },
  steps = {
    { "How far does Verlet's energy stray, by the step? A function of the member's number:", [[
pendulum = dm.system { Q = dm.R(1), L = function(q, v) return v[1]^2/2 + math.cos(q[1]) end }
function study(i)
  local h = 1.9*i/members
  local path = pendulum:solver { rule = "verlet", h = h }:run { q = {1}, v = {0}, t = 200 }
  return { h = h, off = path:drift("energy").largest }
end
file = os.tmpname() .. ".journal"
sweep = dm.sweep { members = members, run = study, journal = file }
print(sweep)
sweep:plot("h", "off", { log = "y", width = 64, height = 16 })]] },
    { "The machine fails: the end of the file is lost.", [[
f = io.open(file, "rb")
bytes = f:read "a"
f:close()
f = io.open(file, "wb")
f:write(bytes:sub(1, #bytes*2//3))
f:close()
print(dm.journal(file))]] },
    { "The same call again:", [[
again = dm.sweep { members = members, run = study, journal = file }
os.remove(file)
same = true
for i = 1, members do same = same and (again.off[i] == sweep.off[i] or again.status[i] ~= "ok") end
print("found", again.journal.found, "run", again.journal.run, "the same bits:", same)]] },
  },
  claim = function(e)
    return e.same and e.again.journal.run > 0 and e.again.journal.found > 0,
      ([[%d members were in the journal, %d were run again; all are, bit for bit, what they were.]])
        :format(e.again.journal.found, e.again.journal.run)
  end,
}
