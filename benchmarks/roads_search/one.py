import sys; sys.argv=[sys.argv[0]]+sys.argv[1:]
exec(open('/tmp/tr/hexes.py').read())
